// SPDX-License-Identifier: Apache-2.0
#include "lab/drop_edges/drop_scene.hpp"

#include <cmath>

#include "surefoot/camera/camera_model.hpp"

namespace surefoot {

using Eigen::Vector2d;
using Eigen::Vector3d;

sim::Scene drop_scene(const Drop& drop, double edge_x_m, double yaw_rad, Rng& rng) {
    constexpr double kGoing_m = 0.31;
    constexpr double kReach_m = 4.0;
    sim::Scene scene;
    // A white wall has no texture to match, so this experiment cannot use white_wall for the floor.
    const auto pattern = [&] {
        sim::Pattern drawn = sim::Pattern::white_wall;
        while (drawn == sim::Pattern::white_wall)
            drawn = static_cast<sim::Pattern>(rng.below(sim::kPatterns));
        return drawn;
    };
    const sim::Pattern upper_pattern = pattern();
    const sim::Pattern lower_pattern = pattern();
    const int upper = scene.add_material(zed_look(upper_pattern, rng.next_u64()));
    const int lower = scene.add_material(zed_look(lower_pattern, rng.next_u64()));
    const Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
    const double bottom_m = -drop.steps * drop.rise_m;
    const auto slab =
        [&](double from_m, double to_m, double top_m, int material, sim::Label label) {
            const Vector2d center = Vector2d(edge_x_m, 0.0) + 0.5 * (from_m + to_m) * along;
            scene.add(sim::make_box(
                          center, {to_m - from_m, 2.0 * kReach_m}, bottom_m - 0.5, top_m, yaw_rad),
                      material,
                      label);
        };
    slab(-kReach_m, 0.0, 0.0, upper, sim::Label::floor);
    for (int step = 1; step < drop.steps; ++step) {
        slab((step - 1) * kGoing_m, step * kGoing_m, -step * drop.rise_m, upper, sim::Label::step);
    }
    slab((drop.steps - 1) * kGoing_m, kReach_m, bottom_m, lower, sim::Label::drop);
    return scene;
}

Sight sight_of(const sim::Scene& scene,
               const camera::StereoRig& rig,
               const Pose& T_world_body,
               const Vector3d& point_m) {
    constexpr double kMargin_px = 8.0;
    constexpr double kRange_m = 2.8;
    bool blocked = false;
    for (const bool right : {false, true}) {
        const Pose T_world_camera =
            T_world_body * rig.body_from_left() * (right ? rig.T_left_right : Pose{});
        const Vector3d way = point_m - T_world_camera.translation_m;
        const auto pixel = camera::project(rig.left.model, T_world_camera.inverse() * point_m);
        if (way.norm() > kRange_m || !pixel || pixel->x() < kMargin_px || pixel->y() < kMargin_px ||
            pixel->x() > rig.left.width - kMargin_px || pixel->y() > rig.left.height - kMargin_px)
            return Sight::outside;
        blocked = blocked ||
                  scene.blocked(T_world_camera.translation_m, way.normalized(), way.norm() - 1e-6);
    }
    return blocked ? Sight::hidden : Sight::seen;
}

Sight sight_of_cell(const sim::Scene& scene,
                    const camera::StereoRig& rig,
                    const std::vector<Pose>& T_world_body,
                    const Vector2d& center_m) {
    constexpr int kSide = 5;
    int seen = 0;
    int hidden = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int row = i / kSide;
        const int column = i % kSide;
        const Vector2d offset((column + 0.5) / kSide - 0.5, (row + 0.5) / kSide - 0.5);
        const Vector2d at = center_m + kCellSize_m * offset;
        const auto top = scene.height_at(at.x(), at.y());
        if (!top) continue;
        bool ever_seen = false;
        bool ever_hidden = false;
        for (const Pose& T : T_world_body) {
            if (ever_seen) break;
            const Sight sight = sight_of(scene, rig, T, {at.x(), at.y(), top->z_m});
            ever_seen = sight == Sight::seen;
            ever_hidden = ever_hidden || sight == Sight::hidden;
        }
        seen += ever_seen ? 1 : 0;
        hidden += !ever_seen && ever_hidden ? 1 : 0;
    }
    constexpr int kAll = kSide * kSide;
    return seen == kAll               ? Sight::seen
           : hidden == kAll           ? Sight::hidden
           : seen == 0 && hidden == 0 ? Sight::outside
                                      : Sight::partly;
}

}  // namespace surefoot
