// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/safety_figures.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/sim/safety_oracle/swept_box.hpp"

namespace surefoot::sim::rules {
namespace {

double metres(std::int32_t tenth_mm) {
    return 1e-4 * tenth_mm;
}

Rect rect_of(const GroundBox& box) {
    const Eigen::Vector2d center(metres(box.center_x_tenth_mm), metres(box.center_y_tenth_mm));
    const Eigen::Vector2d half(0.5 * metres(box.length_tenth_mm), 0.5 * metres(box.width_tenth_mm));
    return {center - half, center + half};
}

}  // namespace

const Movement* movement_of(const Machine& machine, int command) {
    if (command < 0 || command >= Machine::kMovementCodes) return nullptr;
    const Movement& movement = machine.movements[static_cast<std::size_t>(command)];
    const auto movement_class = static_cast<std::size_t>(movement.movement_class);
    const bool enabled = machine.limits.step[movement_class].enabled;
    return movement.configured && enabled ? &movement : nullptr;
}

Figures figures_of(const Machine& machine, const Movement& movement) {
    const GateLimits& limits = machine.limits;
    const StepLimits& step = limits.step[static_cast<std::size_t>(movement.movement_class)];
    Figures f;
    f.feet = {rect_of(machine.left_foot), rect_of(machine.right_foot)};
    for (const BodyPart& part : machine.body.all()) {
        f.body.push_back(
            {rect_of(part.box), metres(part.low_tenth_mm), metres(part.high_tenth_mm)});
        f.height_m = std::max(f.height_m, f.body.back().high_m);
    }
    f.sway_m = metres(machine.body.sway_tenth_mm);
    f.lower_edge_m = metres(machine.body.lower_edge_tenth_mm());
    f.hips_m = metres(machine.sole_depth_tenth_mm);
    f.up_m = metres(step.up_tenth_mm);
    f.down_m = metres(step.down_tenth_mm);
    f.tilt_rad = std::acos(limits.min_normal_z);
    f.patch_side_m = metres(limits.patch_side_tenth_mm);
    f.residual_m = metres(limits.patch_residual_tenth_mm);
    // If the movement class allows a higher landing, the foot is lifted to that height.
    f.clearance_m = std::max(metres(limits.swing_clearance_tenth_mm), f.up_m);
    f.swing_m = metres(limits.swing_clearance_tenth_mm);
    f.foot_margin_m = metres(limits.foot_margin_tenth_mm);
    f.drop_m = metres(limits.drop_tenth_mm);
    f.band_m = metres(limits.drop_band_tenth_mm);
    if (movement.movement_class == MovementClass::stair) {
        f.treads = {metres(machine.ankle_from_heel_tenth_mm),
                    1e-3 * limits.tread_share_permille,
                    metres(limits.tread_overhang_tenth_mm)};
    }
    f.T_start_target = {{metres(movement.forward_tenth_mm), metres(movement.left_tenth_mm)},
                        movement.cos_turn,
                        movement.sin_turn};
    return f;
}

Figures stricter(const Figures& figures, double share, double taller_m) {
    Figures f = figures;
    for (double* limit : {&f.up_m,
                          &f.down_m,
                          &f.tilt_rad,
                          &f.residual_m,
                          &f.clearance_m,
                          &f.swing_m,
                          &f.drop_m,
                          &f.lower_edge_m}) {
        *limit *= 1.0 - share;
    }
    for (double* room : {&f.sway_m, &f.foot_margin_m, &f.band_m}) *room *= 1.0 + share;
    if (f.treads) {
        f.treads->share = std::min(1.0, f.treads->share * (1.0 + share));
        f.treads->overhang_m *= 1.0 - share;
    }
    for (Figures::Part& part : f.body) {
        part.low_m *= 1.0 - share;
        part.high_m += taller_m;
    }
    f.height_m += taller_m;
    return f;
}

Rect region_of(const Figures& figures, double slack_m) {
    const PlanarPose start;
    const double around_m = std::max(figures.band_m, figures.foot_margin_m);
    Rect region = figures.feet[0];
    const auto include = [&](const Rect& box, double by_m) {
        const Rect way = SweptBox(grown(box, by_m), start, figures.T_start_target).bounds();
        region.min_m = region.min_m.cwiseMin(way.min_m);
        region.max_m = region.max_m.cwiseMax(way.max_m);
    };
    for (const Rect& foot : figures.feet) include(foot, around_m);
    for (const Figures::Part& part : figures.body) include(part.box, figures.sway_m);
    return grown(region, slack_m);
}

}  // namespace surefoot::sim::rules
