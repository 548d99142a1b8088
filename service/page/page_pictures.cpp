// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::page {
namespace {

std::string encoded(const cv::Mat& picture) {
    constexpr int kQuality = 80;
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
    return {bytes.begin(), bytes.end()};
}

}  // namespace

std::string jpeg_of(const GreyImage& image) {
    if (image.empty()) return {};
    cv::Mat grey(image.height(), image.width(), CV_8UC1);
    std::copy_n(image.data(), image.size(), grey.data);
    return encoded(grey);
}

std::string jpeg_of_disparity(const Image<float>& disparity_px) {
    if (disparity_px.empty()) return {};
    const auto known = [](float d) { return std::isfinite(d) && d > 0.0F; };
    float most_px = 1.0F;
    for (std::size_t i = 0; i < disparity_px.size(); ++i) {
        if (known(disparity_px.data()[i])) most_px = std::max(most_px, disparity_px.data()[i]);
    }
    cv::Mat scaled(disparity_px.height(), disparity_px.width(), CV_8UC1);
    cv::Mat unknown(scaled.size(), CV_8UC1);
    for (std::size_t i = 0; i < disparity_px.size(); ++i) {
        const float d = disparity_px.data()[i];
        scaled.data[i] = known(d) ? saturated_integer<std::uint8_t>(255.0F * d / most_px) : 0;
        unknown.data[i] = known(d) ? 0 : 255;
    }
    cv::Mat coloured;
    cv::applyColorMap(scaled, coloured, cv::COLORMAP_CIVIDIS);
    coloured.setTo(cv::Scalar(0, 0, 0), unknown);
    return encoded(coloured);
}

}  // namespace surefoot::page
