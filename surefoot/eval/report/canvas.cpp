// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::eval {
namespace {

/// Text is drawn this many times larger and then reduced by area. The stroke font then has smooth,
/// evenly weighted lines at every size.
constexpr int kTextOversampling = 8;
constexpr double kHersheyCapHeight = 21.0;  ///< height of FONT_HERSHEY_SIMPLEX capitals at scale 1
constexpr int kShift = 4;                   ///< fractional bits of OpenCV's coordinates: 1/16 px

cv::Mat as_mat(Picture& picture) {
    static_assert(sizeof(Rgb8) == 3);
    return {picture.height(), picture.width(), CV_8UC3, picture.data()};
}

cv::Scalar scalar(Rgb8 color) {
    return {double(color.r), double(color.g), double(color.b)};
}

/// OpenCV puts pixel centres at whole numbers, this code at halves.
cv::Point fixed_point(PointPx p) {
    const double scale = 1 << kShift;
    return {nearest_px((p.u - 0.5) * scale), nearest_px((p.v - 0.5) * scale)};
}

struct HersheyText {
    double scale;
    int thickness;
    cv::Size size;  ///< oversampled
};

HersheyText measure(const std::string& text, const TextStyle& style) {
    HersheyText hershey{};
    const double cap = style.cap_height_px * kTextOversampling;
    hershey.scale = cap / kHersheyCapHeight;
    hershey.thickness = std::max(1, nearest_px(cap * (style.bold ? 0.19 : 0.125)));
    int baseline = 0;
    hershey.size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, hershey.scale, 1, &baseline);
    return hershey;
}

/// Returns the coverage of the text, 0 to 255, with `pad_px` around the box of the capitals on
/// every side.
cv::Mat text_mask(const std::string& text,
                  const HersheyText& hershey,
                  const TextStyle& style,
                  int pad_px,
                  int extra_thickness) {
    const auto up = [](double px) { return saturated_integer<int>(std::ceil(px)); };
    const int width = up(static_cast<double>(hershey.size.width) / kTextOversampling) + 2 * pad_px;
    const int height = up(style.cap_height_px) + 2 * pad_px;
    cv::Mat large = cv::Mat::zeros(height * kTextOversampling, width * kTextOversampling, CV_8U);
    const cv::Point origin(pad_px * kTextOversampling,
                           nearest_px((pad_px + style.cap_height_px) * kTextOversampling));
    cv::putText(large,
                text,
                origin,
                cv::FONT_HERSHEY_SIMPLEX,
                hershey.scale,
                cv::Scalar(255),
                hershey.thickness + extra_thickness,
                cv::LINE_8);
    cv::Mat mask;
    cv::resize(large, mask, cv::Size(width, height), 0.0, 0.0, cv::INTER_AREA);
    if (style.upward) cv::rotate(mask, mask, cv::ROTATE_90_COUNTERCLOCKWISE);
    return mask;
}

void blend(Picture& picture, const cv::Mat& mask, int left, int top, Rgb8 color) {
    for (int v = std::max(0, -top); v < mask.rows && top + v < picture.height(); ++v) {
        for (int u = std::max(0, -left); u < mask.cols && left + u < picture.width(); ++u) {
            Rgb8& pixel = picture.at(left + u, top + v);
            const std::uint8_t cover = mask.at<std::uint8_t>(v, u);
            if (cover > 0) pixel = mixed(pixel, color, cover / 255.0);
        }
    }
}

}  // namespace

int nearest_px(double place_px) noexcept {
    constexpr int kFarthest_px = 1 << 30;
    return clamped_integer<int>(std::round(place_px), -kFarthest_px, kFarthest_px);
}

double text_width_px(const std::string& text, const TextStyle& style) {
    return static_cast<double>(measure(text, style).size.width) / kTextOversampling;
}

void draw_text(Picture& picture, PointPx at, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    const HersheyText hershey = measure(text, style);
    const int pad_px =
        saturated_integer<int>(std::ceil(0.8 * style.cap_height_px));  // descenders, halo
    const double width = static_cast<double>(hershey.size.width) / kTextOversampling;
    const double share = style.anchor == TextAnchor::left     ? 0.0
                         : style.anchor == TextAnchor::centre ? 0.5
                                                              : 1.0;
    const double half_cap = 0.5 * style.cap_height_px;
    const auto draw = [&](int extra_thickness, Rgb8 color) {
        const cv::Mat mask = text_mask(text, hershey, style, pad_px, extra_thickness);
        double left = at.u - share * width - pad_px;
        double top = at.v - half_cap - pad_px;
        if (style.upward) {
            left = at.u - half_cap - pad_px;
            top = at.v + share * width + pad_px - mask.rows;
        }
        blend(picture, mask, nearest_px(left), nearest_px(top), color);
    };
    if (style.halo) {
        const double halo_px = std::max(2.0, 0.3 * style.cap_height_px);
        draw(saturated_integer<int>(2.0 * halo_px * kTextOversampling), palette::kPaper);
    }
    draw(0, style.color);
}

void draw_line(Picture& picture, PointPx from, PointPx to, int width_px, Rgb8 color) {
    cv::Mat mat = as_mat(picture);
    cv::line(mat, fixed_point(from), fixed_point(to), scalar(color), width_px, cv::LINE_AA, kShift);
}

void draw_polyline(
    Picture& picture, std::span<const PointPx> points, int width_px, Rgb8 color, bool closed) {
    if (points.size() < 2) return;
    std::vector<cv::Point> fixed;
    for (const PointPx& p : points) fixed.push_back(fixed_point(p));
    cv::Mat mat = as_mat(picture);
    cv::polylines(mat, fixed, closed, scalar(color), width_px, cv::LINE_AA, kShift);
}

void fill_polygon(Picture& picture, std::span<const PointPx> points, Rgb8 color) {
    if (points.size() < 3) return;
    std::vector<cv::Point> fixed;
    for (const PointPx& p : points) fixed.push_back(fixed_point(p));
    cv::Mat mat = as_mat(picture);
    cv::fillPoly(
        mat, std::vector<std::vector<cv::Point>>{fixed}, scalar(color), cv::LINE_AA, kShift);
}

void draw_circle(Picture& picture, PointPx center, double radius_px, int width_px, Rgb8 color) {
    cv::Mat mat = as_mat(picture);
    cv::circle(mat,
               fixed_point(center),
               nearest_px(radius_px * (1 << kShift)),
               scalar(color),
               width_px,
               cv::LINE_AA,
               kShift);
}

void fill_circle(Picture& picture, PointPx center, double radius_px, Rgb8 color) {
    draw_circle(picture, center, radius_px, cv::FILLED, color);
}

void fill_rect(Picture& picture, const RectPx& rect, Rgb8 color, double opacity) {
    for (int v = std::max(0, rect.top); v < std::min(picture.height(), rect.bottom()); ++v) {
        for (int u = std::max(0, rect.left); u < std::min(picture.width(), rect.right()); ++u) {
            picture.at(u, v) = mixed(picture.at(u, v), color, opacity);
        }
    }
}

void draw_rect(Picture& picture, const RectPx& rect, int width_px, Rgb8 color) {
    const int w = width_px;
    fill_rect(picture, {rect.left - w, rect.top - w, rect.width + 2 * w, w}, color);
    fill_rect(picture, {rect.left - w, rect.bottom(), rect.width + 2 * w, w}, color);
    fill_rect(picture, {rect.left - w, rect.top, w, rect.height}, color);
    fill_rect(picture, {rect.right(), rect.top, w, rect.height}, color);
}

void paste(Picture& picture, const Picture& source, int left, int top) {
    for (int v = std::max(0, -top); v < source.height() && top + v < picture.height(); ++v) {
        for (int u = std::max(0, -left); u < source.width() && left + u < picture.width(); ++u) {
            picture.at(left + u, top + v) = source.at(u, v);
        }
    }
}

Rgb8 hatched_grey(int u, int v) noexcept {
    constexpr Rgb8 kGround{240, 241, 243};
    constexpr Rgb8 kStripe{221, 223, 227};
    constexpr Rgb8 kFlank{231, 232, 235};
    switch ((u + v) % 12) {
        case 0:
        case 3: return kFlank;
        case 1:
        case 2: return kStripe;
        default: return kGround;
    }
}

std::vector<std::uint8_t> encode_png(const Picture& picture) {
    if (picture.empty()) return {};
    cv::Mat bgr;
    Picture copy = picture;  // cv::Mat has no const view
    cv::cvtColor(as_mat(copy), bgr, cv::COLOR_RGB2BGR);
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9});
    return bytes;
}

}  // namespace surefoot::eval
