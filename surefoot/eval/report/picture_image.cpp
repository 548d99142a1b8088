// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/eval/report/picture_range.hpp"

namespace surefoot::eval {
namespace {

constexpr int kImageWidth_px = 1000;  ///< smaller images are enlarged to about this width
constexpr int kLargestImage_px = 1600;

/// Returns the number of shown pixels per image pixel.
double image_scale(int width, int height) {
    const double enlarged = std::max(1.0, static_cast<double>(kImageWidth_px) / width);
    return std::min(enlarged, static_cast<double>(kLargestImage_px) / std::max(width, height));
}

struct Size {
    int width;
    int height;
};
Size shown_size(int width, int height) {
    const double scale = image_scale(width, height);
    return {std::max(1, nearest_px(width * scale)), std::max(1, nearest_px(height * scale))};
}

/// Draws a number per pixel as a figure with a legend; pixels without a number are hatched.
Picture render_values(const Image<float>& values,
                      const LayerStyle& style,
                      const std::optional<SecondScale>& second,
                      const std::string& unknown_label) {
    const std::vector<KeyEntry> key = {{Symbol::hatch, {}, unknown_label, {}}};
    ColorBar bar = color_bar_of(values, style);
    bar.second = second;
    const Size size = shown_size(std::max(1, values.width()), std::max(1, values.height()));
    Figure figure = make_figure(size.width,
                                size.height,
                                false,
                                column_size(key, second ? BarKind::two_scales : BarKind::one_scale),
                                style.text);
    for (int v = 0; v < size.height; ++v) {
        for (int u = 0; u < size.width && !values.empty(); ++u) {
            const int from_u = u * values.width() / size.width;
            const int from_v = v * values.height() / size.height;
            const auto value = static_cast<double>(values.at(from_u, from_v));
            figure.picture.at(figure.plot.left + u, figure.plot.top + v) =
                std::isfinite(value) ? bar.scale(style.value_scale * value) : hatched_grey(u, v);
        }
    }
    draw_rect(figure.picture, figure.plot, 2, palette::kInk);
    const int below = draw_color_bar(figure, bar, static_cast<int>(key.size()));
    draw_key(figure, below, key);
    return std::move(figure.picture);
}

}  // namespace

Picture render_camera_image(const GreyImage& image, const FigureText& text) {
    const Size size = shown_size(std::max(1, image.width()), std::max(1, image.height()));
    Figure figure = make_figure(size.width, size.height, false, {}, text);
    if (!image.empty()) {
        GreyImage copy = image;  // cv::Mat has no const view
        const cv::Mat small(copy.height(), copy.width(), CV_8U, copy.data());
        cv::Mat large;
        const bool shrinks = size.width < image.width();
        cv::resize(small,
                   large,
                   cv::Size(size.width, size.height),
                   0.0,
                   0.0,
                   shrinks ? cv::INTER_AREA : cv::INTER_CUBIC);
        for (int v = 0; v < size.height; ++v) {
            for (int u = 0; u < size.width; ++u) {
                const auto grey = large.at<std::uint8_t>(v, u);
                figure.picture.at(figure.plot.left + u, figure.plot.top + v) = {grey, grey, grey};
            }
        }
    }
    draw_rect(figure.picture, figure.plot, 2, palette::kInk);
    return std::move(figure.picture);
}

Picture render_disparity(const Image<float>& disparity_px,
                         double depth_times_disparity_m_px,
                         const FigureText& text) {
    LayerStyle style;
    style.text = text;
    style.unit = "px";
    style.min_span = 1.0;
    std::optional<SecondScale> depth;
    if (depth_times_disparity_m_px > 0.0) {
        const auto depth_m = [depth_times_disparity_m_px](double disparity) {
            return disparity > 0.0 ? depth_times_disparity_m_px / disparity : HUGE_VAL;
        };
        depth =
            SecondScale{"m", depth_m, {1.0,  2.0, 5.0, 10.0, 20.0, 50.0, 0.5, 3.0, 30.0, 1.5, 4.0,
                                       15.0, 7.0, 0.7, 2.5,  6.0,  8.0,  0.8, 1.2, 0.6,  0.4, 0.3}};
    }
    return render_values(disparity_px, style, depth, "no match");
}

Picture render_sigma(const Image<float>& sigma, const std::string& unit, const FigureText& text) {
    LayerStyle style;
    style.text = text;
    style.unit = unit;
    style.map = ColorMap::cividis;
    return render_values(sigma, style, std::nullopt, "no match");
}

}  // namespace surefoot::eval
