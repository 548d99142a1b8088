// SPDX-License-Identifier: Apache-2.0
#include "lab/scenes/scene_sight.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/core/unknown.hpp"

namespace surefoot::experiments {

using Eigen::Vector2d;
using Eigen::Vector3d;

Heights heights_at(const HazardScene& scene, const Vector2d& p_m) {
    const Solid* highest = nullptr;
    for (const Solid& solid : scene.solids) {
        if (solid.covers(p_m) && (highest == nullptr || solid.top_m > highest->top_m))
            highest = &solid;
    }
    if (highest == nullptr) return {kNan, kNan, std::numeric_limits<double>::infinity()};
    const Solid* below = nullptr;  // the highest other solid at this point
    bool joined = false;           // true: another solid reaches up to the highest solid
    for (const Solid& solid : scene.solids) {
        if (&solid == highest || !solid.covers(p_m)) continue;
        if (solid.top_m >= highest->bottom_m) joined = true;
        if (below == nullptr || solid.top_m > below->top_m) below = &solid;
    }
    if (below == nullptr || joined)
        return {highest->top_m, highest->top_m, std::numeric_limits<double>::infinity()};
    return {highest->top_m, below->top_m, highest->bottom_m};
}

Sight::Sight(const HazardScene& scene, const camera::RectifiedRig& rig)
    : scene_(&scene), rig_(rig) {
    constexpr double kStep_m = 0.15;
    constexpr double kTurn_rad = std::numbers::pi / 4.0;
    const Vector3d here_m = scene.T_world_body.translation_m;
    const auto add = [&](double yaw_rad, double back_m, double walked_yaw_rad) {
        Pose T_world_body;
        T_world_body.rotation = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ());
        T_world_body.translation_m =
            here_m - back_m * Vector3d(std::cos(walked_yaw_rad), std::sin(walked_yaw_rad), 0.0);
        T_world_camera_.push_back(T_world_body * rig_.T_body_camera);
    };
    const double walked_rad = scene.turned ? scene.yaw_rad - std::numbers::pi : scene.yaw_rad;
    if (scene.turned) {
        for (int k = 4; k > 0; --k) add(walked_rad + k * kTurn_rad, 0.0, walked_rad);
    }
    for (double back_m = 0.0; back_m < scene.way_m; back_m += kStep_m)
        add(walked_rad, back_m, walked_rad);
    add(walked_rad, scene.way_m, walked_rad);
}

bool Sight::both_see(const Pose& T_world_camera, const Vector3d& p_m) const {
    constexpr double kBorder_px = 6.0;  // half a window of the matcher
    constexpr double kRange_m = 2.8;
    const Vector3d p = T_world_camera.rotation.conjugate() * (p_m - T_world_camera.translation_m);
    if (p.z() < 0.2 || p.norm() > kRange_m) return false;
    const double v_px = rig_.cy_px + rig_.fy_px * p.y() / p.z();
    const double left_px = rig_.cx_px + rig_.fx_px * p.x() / p.z();
    const double right_px = left_px - rig_.fx_px * rig_.baseline_m / p.z();
    if (v_px < kBorder_px || v_px > rig_.height - kBorder_px || right_px < kBorder_px ||
        left_px > rig_.width - kBorder_px)
        return false;
    const Vector3d right_camera_m = T_world_camera * Vector3d(rig_.baseline_m, 0.0, 0.0);
    for (const Vector3d& camera_m : {T_world_camera.translation_m, right_camera_m}) {
        const Vector3d short_of_m = p_m + 1e-3 * (camera_m - p_m).normalized();
        for (const Solid& solid : scene_->solids)
            if (solid.blocks(camera_m, short_of_m)) return false;
    }
    return true;
}

Sight::Look Sight::look(const Vector3d& p_m, int most) const {
    Look look;
    for (const Pose& T : T_world_camera_) {
        if (look.looks >= most) break;
        if (!both_see(T, p_m)) continue;
        const double distance_m = (T.translation_m - p_m).norm();
        look.nearest_m = look.looks == 0 ? distance_m : std::min(look.nearest_m, distance_m);
        ++look.looks;
    }
    return look;
}

}  // namespace surefoot::experiments
