// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/describe.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/features2d.hpp>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/nearest_pixel.hpp"

namespace surefoot::place_recognition {
namespace {

constexpr double kScale = 1.2;  ///< ratio of the image sizes of two levels of the pyramid
constexpr int kBorder_px = 31;  ///< half the side of the area that a descriptor and its blur use
constexpr int kPatch_px = 31;

/// Returns the disparity of a corner, or NaN if the disparity is unknown or unreliable.
float disparity_at(const DescribeConfig& config, const DepthImage& depth, float u, float v) {
    const Image<float>& disparity_px = depth.disparity_px;
    const auto nearest = nearest_pixel(static_cast<double>(u),
                                       static_cast<double>(v),
                                       disparity_px.width(),
                                       disparity_px.height());
    if (!nearest) return std::nanf("");
    const float d = disparity_px.at(nearest->u, nearest->v);
    const bool sure = static_cast<double>(depth.outlier_probability.at(nearest->u, nearest->v)) <=
                          config.max_outlier_probability &&
                      static_cast<double>(d) >= config.min_disparity_px;
    return sure ? d : std::nanf("");
}

/// Order of corners: the strongest first, equally strong corners in image order.
bool stronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
    if (a.response != b.response) return a.response > b.response;
    if (a.octave != b.octave) return a.octave < b.octave;
    return a.pt.y != b.pt.y ? a.pt.y < b.pt.y : a.pt.x < b.pt.x;
}

/// Keeps the strongest corners of each grid cell, so that one rich area does not use up the limit.
void spread(const DescribeConfig& config, cv::Size size, std::vector<cv::KeyPoint>& corners) {
    std::sort(corners.begin(), corners.end(), stronger);
    std::vector<int> count(static_cast<std::size_t>(config.grid_columns * config.grid_rows));
    std::erase_if(corners, [&](const cv::KeyPoint& corner) {
        const int column = static_cast<int>(corner.pt.x) * config.grid_columns / size.width;
        const int row = static_cast<int>(corner.pt.y) * config.grid_rows / size.height;
        return ++count[static_cast<std::size_t>(row * config.grid_columns + column)] >
               config.cell_features;
    });
    if (corners.size() > static_cast<std::size_t>(kMostFeatures))
        corners.resize(static_cast<std::size_t>(kMostFeatures));
}

}  // namespace

std::vector<Feature> describe(const DescribeConfig& config,
                              ImageView<const std::uint8_t> left,
                              const DepthImage& depth) {
    SUREFOOT_ASSERT(depth.disparity_px.width() == left.width &&
                    depth.disparity_px.height() == left.height);
    if (left.width <= 2 * kBorder_px || left.height <= 2 * kBorder_px) return {};
    // OpenCV has no view of constant pixels. `detect` and `compute` only read the pixels.
    const cv::Mat image(left.height,
                        left.width,
                        CV_8UC1,
                        const_cast<std::uint8_t*>(left.data),  // NOLINT
                        static_cast<std::size_t>(left.stride));
    const auto orb = cv::ORB::create(config.corners,
                                     static_cast<float>(kScale),
                                     config.pyramid_levels,
                                     kBorder_px,
                                     0,
                                     2,
                                     cv::ORB::HARRIS_SCORE,
                                     kPatch_px,
                                     config.fast_threshold);
    std::vector<cv::KeyPoint> corners;
    orb->detect(image, corners);
    std::erase_if(corners, [&](const cv::KeyPoint& corner) {
        return std::isnan(disparity_at(config, depth, corner.pt.x, corner.pt.y));
    });
    spread(config, image.size(), corners);
    for (cv::KeyPoint& corner : corners) corner.angle = 0.0F;
    cv::Mat rows;
    orb->compute(image, corners, rows);
    std::vector<Feature> features(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const cv::Point2f& at = corners[i].pt;
        features[i].pixel_px = {at.x, at.y, at.x - disparity_at(config, depth, at.x, at.y)};
        const std::uint8_t* bytes = rows.ptr<std::uint8_t>(static_cast<int>(i));
        for (std::size_t k = 0; k < 32; ++k)  // the first byte is the lowest, on every machine
            features[i].descriptor.bits[k / 8] |= std::uint64_t{bytes[k]} << (8 * (k % 8));
    }
    return features;
}

}  // namespace surefoot::place_recognition
