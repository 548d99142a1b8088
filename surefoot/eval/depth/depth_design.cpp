// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/depth_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/angles.hpp"

namespace surefoot::eval {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kRows_px = 3.0;

/// Returns half of the vertical field of view; assumes the principal point in the middle of the
/// image.
double half_view_rad(const DepthDesign& design) {
    return std::atan2(0.5 * design.height, design.focal_px);
}

}  // namespace

std::optional<std::string> DepthDesign::problem() const {
    const struct {
        const char* name;
        double value, min, max;
    } rows[] = {{"--baseline [m]", baseline_m, 1e-3, 10.0},
                {"--focal [px]", focal_px, 10.0, 1e5},
                {"width of --size [px]", static_cast<double>(width), 16.0, 16384.0},
                {"height of --size [px]", static_cast<double>(height), 16.0, 16384.0},
                {"--sigma [px]", sigma_px, 1e-3, 10.0},
                {"--height [m]", camera_height_m, 0.1, 5.0},
                {"--pitch [deg]", pitch_deg, 0.0, 80.0}};
    for (const auto& row : rows) {
        if (!(row.value >= row.min && row.value <= row.max)) {
            return fmt::format(
                "{} = {} must be between {} and {}", row.name, row.value, row.min, row.max);
        }
    }
    return std::nullopt;
}

ResolvableHeight resolvable_height(const DepthDesign& design, double range_m) {
    const double way_m = std::hypot(range_m, design.camera_height_m);
    const double down_rad = std::atan2(design.camera_height_m, range_m);
    const double off_axis_rad = down_rad - design.pitch_deg * kRadPerDeg;
    const double fb_px_m = design.focal_px * design.baseline_m;
    ResolvableHeight result;
    result.range_m = range_m;
    result.in_view = std::abs(off_axis_rad) <= half_view_rad(design);
    result.depth_m = way_m * std::cos(off_axis_rad);
    result.sigma_depth_m = result.depth_m * result.depth_m * design.sigma_px / fb_px_m;
    const double sigma_height_m =
        design.camera_height_m * result.depth_m * design.sigma_px / fb_px_m;
    result.noise_limit_m = kSigmas * std::numbers::sqrt2 * sigma_height_m;
    result.pixel_limit_m = kRows_px * way_m / (design.focal_px * std::cos(down_rad));
    result.height_m = std::max(result.noise_limit_m, result.pixel_limit_m);
    return result;
}

double nearest_floor_m(const DepthDesign& design) {
    const double down_rad = design.pitch_deg * kRadPerDeg + half_view_rad(design);
    if (down_rad >= 0.5 * std::numbers::pi) return 0.0;
    if (down_rad <= 0.0) return std::numeric_limits<double>::infinity();
    return design.camera_height_m / std::tan(down_rad);
}

}  // namespace surefoot::eval
