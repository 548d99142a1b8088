// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/fine_depth.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kTunedPixels = 672.0 * 376.0;
constexpr int kMaxScale = 8;
constexpr double kNearestDepth_m = 0.1;
constexpr int kSlices = 24;  ///< of the fine region
/// Smallest side of a fine region. Smaller regions have less support than the matcher needs.
constexpr int kLeastSide_px = 64;

}  // namespace

void FineConfig::describe(ConfigVisitor& visitor) {
    visitor.integer("scale",
                    scale,
                    0,
                    kMaxScale,
                    "size of the images divided by the size at which every frame is matched; 0 = "
                    "chosen by the size of the images, 1 = every frame is matched at full size "
                    "(then also set stereo.disparities for this size)");
    visitor.number("every_s",
                   every_s,
                   0.0,
                   60.0,
                   "time between two frames of which the fine region is matched at full size; 0 = "
                   "every frame");
    visitor.number("from_m",
                   from_m,
                   -10.0,
                   10.0,
                   "start of the fine region, in front of base_link in its heading");
    visitor.number("to_m", to_m, -10.0, 50.0, "end of the fine region");
    visitor.number(
        "half_width_m", half_width_m, 0.01, 10.0, "half of the width of the fine region");
    visitor.number("depth_m", depth_m, 0.0, 10.0, "lower end of the fine region, below the ground");
    visitor.number(
        "height_m", height_m, 0.0, 10.0, "upper end of the fine region, above the ground");
    visitor.number("still_s",
                   still_s,
                   0.0,
                   10.0,
                   "time without motion after which the fine region is matched at once");
}

std::optional<std::string> FineConfig::problem() const {
    if (from_m < to_m) return std::nullopt;
    return fmt::format("fine.from_m = {} must be less than fine.to_m = {}", from_m, to_m);
}

int fine_scale(const FineConfig& config, int width, int height) noexcept {
    if (config.scale > 0) return std::min({config.scale, width, height});
    const double ratio = std::sqrt(static_cast<double>(width) * height / kTunedPixels);
    // in range: clamped
    return static_cast<int>(std::lround(std::clamp(ratio, 1.0, double{kMaxScale})));
}

stereo::MatcherConfig at_scale(stereo::MatcherConfig coarse, int scale) noexcept {
    coarse.disparities =
        std::min(coarse.disparities * scale, stereo::longest_range_px(coarse.algorithm));
    return coarse;
}

camera::PixelBox fine_region(const FineConfig& config,
                             const camera::RectifiedRig& rig,
                             const Pose& T_odom_body,
                             double ground_height_m,
                             int left_px) {
    if (!T_odom_body.all_finite()) return {};
    const Pose T_camera_odom = (T_odom_body * rig.T_body_camera).inverse();
    const Eigen::Vector3d body_m = T_odom_body.translation_m;
    const Eigen::Vector2d heading = T_odom_body.R().col(0).head<2>();
    const double yaw_rad = std::atan2(heading.y(), heading.x());
    const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    // The region is cut into slices across the heading. Slices below the image would widen the box.
    struct Slice {
        Eigen::AlignedBox2d corners_px;
        bool in_front = false;
    };
    const auto slice_at = [&](double x_m) {
        Slice slice;
        for (const double y_m : {-config.half_width_m, config.half_width_m}) {
            for (const double z_m : {-config.depth_m, config.height_m}) {
                const Eigen::Vector2d at_m = body_m.head<2>() + x_m * ahead + y_m * left;
                Eigen::Vector3d p =
                    T_camera_odom *
                    Eigen::Vector3d(at_m.x(), at_m.y(), body_m.z() - ground_height_m + z_m);
                slice.in_front |= p.z() > kNearestDepth_m;
                p.z() = std::max(p.z(), kNearestDepth_m);
                slice.corners_px.extend(Eigen::Vector2d(rig.fx_px * p.x() / p.z() + rig.cx_px,
                                                        rig.fy_px * p.y() / p.z() + rig.cy_px));
            }
        }
        return slice;
    };
    Eigen::AlignedBox2d region_px;
    Slice before = slice_at(config.from_m);
    for (int i = 1; i <= kSlices; ++i) {
        const Slice here = slice_at(config.from_m + i * (config.to_m - config.from_m) / kSlices);
        Eigen::AlignedBox2d piece_px = before.corners_px.merged(here.corners_px);
        if ((before.in_front || here.in_front) && piece_px.min().y() < rig.height &&
            piece_px.max().y() >= 0.0)
            region_px.extend(piece_px);
        before = here;
    }
    if (region_px.isEmpty()) return {};
    const auto inside = [](double at, int size) {
        // in range: clamped
        return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(size)));
    };
    const int first_u = inside(std::floor(region_px.min().x()), rig.width);
    const int v = inside(std::floor(region_px.min().y()), rig.height);
    const int u_end = inside(std::ceil(region_px.max().x()) + 1.0, rig.width);
    const int v_end = inside(std::ceil(region_px.max().y()) + 1.0, rig.height);
    if (u_end - first_u < kLeastSide_px || v_end - v < kLeastSide_px) return {};
    const int u = std::max(0, first_u - left_px);
    return {u, v, u_end - u, v_end - v};
}

bool FineSchedule::is_due(std::int64_t time_ns, const Pose& T_odom_body) {
    time_ns_ = time_ns;
    const Pose moved = T_odom_still_.inverse() * T_odom_body;
    if (!has_pose_ ||
        !(std::sqrt(moved.translation_m.squaredNorm()) < viewpoint_.min_translation_m &&
          std::sqrt(log_so3(moved.rotation).squaredNorm()) <
              viewpoint_.min_rotation_deg * kRadPerDeg)) {
        has_pose_ = true;
        T_odom_still_ = T_odom_body;
        still_since_ns_ = time_ns;
        is_still_observed_ = false;
    }
    if (!observed_ns_ || time_ns - *observed_ns_ >= ns_from_seconds(config_.every_s)) return true;
    return !is_still_observed_ && time_ns - still_since_ns_ >= ns_from_seconds(config_.still_s);
}

void FineSchedule::observed() noexcept {
    observed_ns_ = time_ns_;
    is_still_observed_ = time_ns_ - still_since_ns_ >= ns_from_seconds(config_.still_s);
}

void FineDepth::measure(const StereoFrame& frame, const camera::PixelBox& box, Executor& executor) {
    rig_ = camera::part_of(rectifier_->rig(), box);
    rectifier_->rectify_part(frame, box, pair_);
    matcher_->match(pair_.left.view(), pair_.right.view(), executor, depth_);
}

}  // namespace surefoot::pipeline
