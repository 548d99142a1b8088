// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/stereo_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "surefoot/core/nearest_pixel.hpp"
#include "surefoot/odometry/visual/patch.hpp"

namespace surefoot::odometry {
namespace {

constexpr int kRadius = 4;  ///< radius of the coarse search window
constexpr int kSize = 2 * kRadius + 1;
constexpr int kCount = kSize * kSize;
constexpr int kKnot_px = 8;      ///< knot spacing; in between the epipolar curve is nearly straight
constexpr int kSamePeak_px = 3;  ///< positions this close belong to one maximum
constexpr double kCorrelationNoise =
    0.05;  ///< smaller differences of the whole-pixel correlation are noise
constexpr double kCoarseCorrelation = 0.6;  ///< smallest correlation before the refinement
constexpr double kRefineShift_px = 2.0;
/// A relative depth step of this size within 3 x 3 pixels is an edge.
constexpr double kDepthEdge = 0.03;

struct Window {
    std::array<float, kCount> value{};
    float norm = 0.0F;
};

bool read_nearest(ImageView<const std::uint8_t> image,
                  const Eigen::Vector2d& at_px,
                  Window& window) {
    const auto middle = nearest_pixel(at_px.x(), at_px.y(), image.width, image.height, kRadius);
    if (!middle) return false;
    float sum = 0.0F;
    std::size_t i = 0;
    for (int dv = -kRadius; dv <= kRadius; ++dv) {
        const std::uint8_t* row = image.row(middle->v + dv) + middle->u - kRadius;
        for (int du = 0; du < kSize; ++du) sum += window.value[i++] = static_cast<float>(row[du]);
    }
    float square = 0.0F;
    for (float& value : window.value) {
        value -= sum / static_cast<float>(kCount);
        square += value * value;
    }
    window.norm = std::sqrt(square);
    return window.norm > 0.0F;
}

double correlation(const Window& a, const Window& b) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < a.value.size(); ++i) sum += a.value[i] * b.value[i];
    return static_cast<double>(sum / (a.norm * b.norm));
}

using Curve = std::vector<std::optional<Eigen::Vector2d>>;

/// Raw pixels in the other camera at disparities 0, 1, 2 ... of one rectified pixel of this camera.
/// The curve is approximated by line segments.
Curve epipolar_curve(const camera::Rectifier& rectifier,
                     camera::Side camera,
                     const Eigen::Vector2d& px,
                     double max_disparity_px) {
    const auto& rig = rectifier.rig();
    const bool is_left = camera == camera::Side::left;
    const auto knot = [&](double disparity) {
        const double u_left = is_left ? px.x() : px.x() + disparity;
        // Disparity 0 is infinitely far; a very small disparity gives the same direction.
        return rectifier.raw_from_point(is_left ? camera::Side::right : camera::Side::left,
                                        rig.point(u_left, px.y(), std::max(disparity, 1e-3)));
    };
    Curve curve;
    auto from = knot(0.0);
    for (double d = 0.0; d < max_disparity_px; d += kKnot_px) {
        const auto to = knot(d + kKnot_px);
        for (int i = 0; i < kKnot_px; ++i) {
            if (from && to)
                curve.emplace_back(*from + (*to - *from) * (1.0 * i / kKnot_px));
            else
                curve.emplace_back(std::nullopt);
        }
        from = to;
    }
    return curve;
}

/// Correlation at each position of the curve, -1 outside the image.
std::vector<double> scores_along(ImageView<const std::uint8_t> right,
                                 const Window& patch,
                                 const Curve& curve) {
    std::vector<double> score(curve.size(), -1.0);
    Window window;
    for (std::size_t d = 0; d < curve.size(); ++d)
        if (curve[d] && read_nearest(right, *curve[d], window))
            score[d] = correlation(patch, window);
    return score;
}

/// Start of the refinement: the best position, if it is clearly better than all others.
std::optional<Eigen::Vector2d> best_place(ImageView<const std::uint8_t> right,
                                          const Window& patch,
                                          const Curve& curve,
                                          double uniqueness) {
    const std::vector<double> score = scores_along(right, patch, curve);
    const auto top_at = std::max_element(score.begin(), score.end());
    if (top_at == score.end() || *top_at < kCoarseCorrelation) return std::nullopt;
    const double top = *top_at;
    const int best = static_cast<int>(top_at - score.begin());
    for (int d = 0; d < static_cast<int>(score.size()); ++d) {
        const double other = score[static_cast<std::size_t>(d)];
        if (std::abs(d - best) > kSamePeak_px &&
            1.0 - other < uniqueness * (1.0 - top) + kCorrelationNoise)
            return std::nullopt;
    }
    return curve[static_cast<std::size_t>(best)];
}

}  // namespace

std::optional<StereoPixel> stereo_pixel(const camera::Rectifier& rectifier,
                                        const Eigen::Vector2d& raw_left_px,
                                        const Eigen::Vector2d& raw_right_px,
                                        const StereoPointConfig& config) {
    const auto left = rectifier.rectified_from_raw(camera::Side::left, raw_left_px);
    const auto right = rectifier.rectified_from_raw(camera::Side::right, raw_right_px);
    if (!left || !right || std::abs(left->y() - right->y()) > config.epipolar_px)
        return std::nullopt;
    const StereoPixel pixel(left->x(), 0.5 * (left->y() + right->y()), right->x());
    if (disparity_px(pixel) < config.min_disparity_px) return std::nullopt;
    return pixel;
}

std::optional<StereoPixel> match_corner(const camera::Rectifier& rectifier,
                                        ImageView<const std::uint8_t> left,
                                        ImageView<const std::uint8_t> right,
                                        const Eigen::Vector2d& raw_left_px,
                                        const StereoPointConfig& config) {
    const auto left_px = rectifier.rectified_from_raw(camera::Side::left, raw_left_px);
    const auto host = cut_patch(left, raw_left_px);
    Window patch;
    if (!left_px || !host || !read_nearest(left, raw_left_px, patch)) return std::nullopt;
    const auto curve =
        epipolar_curve(rectifier, camera::Side::left, *left_px, config.max_disparity_px);
    const auto start = best_place(right, patch, curve, config.uniqueness);
    if (!start) return std::nullopt;
    // The lenses of one rig are similar: locally the two images differ by a shift.
    const auto warped = warp_patch(*host, Eigen::Matrix2d::Identity());
    if (!warped) return std::nullopt;
    const auto aligned = align_patch(*warped, right, *start, kRefineShift_px);
    if (!aligned || aligned->correlation < config.min_correlation) return std::nullopt;
    return stereo_pixel(rectifier, raw_left_px, aligned->raw_px, config);
}

std::optional<camera::Side> camera_of_corner(const camera::Rectifier& rectifier,
                                             ImageView<const std::uint8_t> image,
                                             ImageView<const std::uint8_t> other,
                                             const Eigen::Vector2d& raw_px,
                                             const StereoPointConfig& config) {
    Window patch;
    if (!read_nearest(image, raw_px, patch)) return std::nullopt;
    const auto best_as = [&](camera::Side camera) {
        const auto px = rectifier.rectified_from_raw(camera, raw_px);
        if (!px) return -1.0;
        const auto score = scores_along(
            other, patch, epipolar_curve(rectifier, camera, *px, config.max_disparity_px));
        // At small disparities, the curves of both cameras lie close together and do not tell the
        // cameras apart.
        const auto near = score.begin() + std::min<std::ptrdiff_t>(kSamePeak_px, std::ssize(score));
        return near == score.end() ? -1.0 : *std::max_element(near, score.end());
    };
    const double as_left = best_as(camera::Side::left);
    const double as_right = best_as(camera::Side::right);
    if (std::max(as_left, as_right) < kCoarseCorrelation) return std::nullopt;
    if (std::abs(as_left - as_right) < kCorrelationNoise) return std::nullopt;
    return as_left > as_right ? camera::Side::left : camera::Side::right;
}

std::optional<StereoPixel> depth_pixel(const camera::Rectifier& rectifier,
                                       const Image<float>& depth_m,
                                       const Eigen::Vector2d& raw_left_px,
                                       const StereoPointConfig& config) {
    const auto left = rectifier.rectified_from_raw(camera::Side::left, raw_left_px);
    const auto nearest =
        nearest_pixel(raw_left_px.x(), raw_left_px.y(), depth_m.width(), depth_m.height(), 1);
    if (!left || !nearest) return std::nullopt;
    const auto [u, v] = *nearest;
    const auto z_m = static_cast<double>(depth_m.at(u, v));
    if (!(z_m > 0.0)) return std::nullopt;
    for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du)
            if (!(std::abs(static_cast<double>(depth_m.at(u + du, v + dv)) - z_m) <
                  kDepthEdge * z_m))
                return std::nullopt;
    const double disparity = rectifier.rig().depth_to_disparity_px_m() / z_m;
    if (disparity < config.min_disparity_px) return std::nullopt;
    return StereoPixel(left->x(), left->y(), left->x() - disparity);
}

}  // namespace surefoot::odometry
