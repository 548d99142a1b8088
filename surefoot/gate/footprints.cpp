// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/footprints.hpp"

#include <algorithm>

namespace surefoot::gate {
namespace {

using Corners = std::array<grid::FixedPoint, 4>;

/// Drift that is covered by kBesideTenthMm and the margins of feet and body. Up to this drift, a
/// wrong machine position caused no missed hazard (docs/lab/gate_scenes.md).
constexpr std::int64_t kDriftWithinTenthMm = 100;

/// Returns x / 2^20, rounded to the nearest integer. Halves round upward for both signs of x.
constexpr std::int64_t round_fraction(std::int64_t x) noexcept {
    return grid::floor_div(x + FixedPose::kOne / 2, FixedPose::kOne);
}

/// Returns value * 2^20, rounded. Precondition: |value| <= 1.001; check_numbers(), the snapshot
/// header and Machine::problem() check this.
std::int64_t fraction(double value) noexcept {
    const double scaled = value * static_cast<double>(FixedPose::kOne);
    // in range: at most 1.001 * 2^20
    return static_cast<std::int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

Corners corners_of(const GroundBox& box, const FixedPose& pose, std::int64_t margin) noexcept {
    // Odd sizes grow by 0.1 mm, so that rounding never shrinks a box.
    const std::int64_t half_x = (box.length_tenth_mm + 1) / 2 + margin;
    const std::int64_t half_y = (box.width_tenth_mm + 1) / 2 + margin;
    const std::int64_t x = box.center_x_tenth_mm;
    const std::int64_t y = box.center_y_tenth_mm;
    return {to_odom(pose, x - half_x, y - half_y),
            to_odom(pose, x + half_x, y - half_y),
            to_odom(pose, x + half_x, y + half_y),
            to_odom(pose, x - half_x, y + half_y)};
}

grid::FixedConvex hull_of(const Corners& a, const Corners& b) noexcept {
    std::array<grid::FixedPoint, 8> points{};
    std::copy(a.begin(), a.end(), points.begin());
    std::copy(b.begin(), b.end(), points.begin() + 4);
    return grid::convex_hull(points);
}

/// Returns the region that a box passes over, widened by a margin.
Region swept(const GroundBox& box,
             const FixedPose& start,
             const FixedPose& target,
             std::int64_t margin) noexcept {
    const auto hull = [&](std::int64_t by) {
        return hull_of(corners_of(box, start, by), corners_of(box, target, by));
    };
    return {hull(margin + kBesideTenthMm), hull(margin)};
}

FootSweep foot_sweep(Foot foot,
                     const GroundBox& box,
                     const GateLimits& limits,
                     const FixedPose& start,
                     const FixedPose& target,
                     std::int64_t drift_margin) noexcept {
    FootSweep sweep;
    sweep.foot = foot;
    sweep.stance = grid::convex_hull(corners_of(box, start, 0));
    sweep.landing = grid::convex_hull(corners_of(box, target, 0));
    sweep.landing_center = to_odom(target, box.center_x_tenth_mm, box.center_y_tenth_mm);
    sweep.corridor = swept(box, start, target, limits.foot_margin_tenth_mm + drift_margin);
    sweep.band = swept(box, target, target, limits.drop_band_tenth_mm + drift_margin);
    return sweep;
}

}  // namespace

FixedPose fixed_pose(std::int64_t x_tenth_mm,
                     std::int64_t y_tenth_mm,
                     double cos_yaw,
                     double sin_yaw) noexcept {
    return {{x_tenth_mm, y_tenth_mm}, fraction(cos_yaw), fraction(sin_yaw)};
}

grid::FixedPoint to_odom(const FixedPose& pose,
                         std::int64_t forward_tenth_mm,
                         std::int64_t left_tenth_mm) noexcept {
    const std::int64_t dx = pose.cos_yaw * forward_tenth_mm - pose.sin_yaw * left_tenth_mm;
    const std::int64_t dy = pose.sin_yaw * forward_tenth_mm + pose.cos_yaw * left_tenth_mm;
    return {pose.position.x + round_fraction(dx), pose.position.y + round_fraction(dy)};
}

FixedPose moved(const FixedPose& pose, const Movement& movement) noexcept {
    const std::int64_t cos_turn = fraction(movement.cos_turn);
    const std::int64_t sin_turn = fraction(movement.sin_turn);
    FixedPose target;
    target.position = to_odom(pose, movement.forward_tenth_mm, movement.left_tenth_mm);
    target.cos_yaw = round_fraction(pose.cos_yaw * cos_turn - pose.sin_yaw * sin_turn);
    target.sin_yaw = round_fraction(pose.sin_yaw * cos_turn + pose.cos_yaw * sin_turn);
    return target;
}

void Extent::include(grid::FixedPoint p) noexcept {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
}

Extent extent_of(const Sweep& sweep) noexcept {
    Extent extent{sweep.target.position, sweep.target.position};
    const auto include = [&extent](const grid::FixedConvex& polygon) {
        for (const grid::FixedPoint& p : polygon.points()) extent.include(p);
    };
    for (const FootSweep& foot : sweep.feet) {
        include(foot.stance);
        include(foot.corridor.around);
        include(foot.band.around);
    }
    for (const Sweep::Part& part : sweep.body) include(part.region.around);
    return extent;
}

std::int64_t drift_margin(const GateLimits& limits, std::int64_t drift_tenth_mm) noexcept {
    const std::int64_t beyond = drift_tenth_mm - kDriftWithinTenthMm;
    if (beyond <= 0) return 0;
    // in range: sigma_factor is at most 10 (Machine::problem()), a drift has 16 bits
    return static_cast<std::int64_t>(limits.sigma_factor * static_cast<double>(beyond)) + 1;
}

Sweep sweep_of(const Machine& machine,
               const FixedPose& start,
               const Movement& movement,
               std::int64_t margin_tenth_mm) noexcept {
    Sweep sweep;
    sweep.target = moved(start, movement);
    sweep.feet = {
        foot_sweep(
            Foot::left, machine.left_foot, machine.limits, start, sweep.target, margin_tenth_mm),
        foot_sweep(
            Foot::right, machine.right_foot, machine.limits, start, sweep.target, margin_tenth_mm)};
    std::size_t part = 0;
    for (const auto& [box, low, high] : machine.body.all()) {
        const std::int64_t sway = machine.body.sway_tenth_mm;
        sweep.body[part++] = {swept(box, start, sweep.target, sway + margin_tenth_mm),
                              grid::convex_hull(corners_of(box, start, sway))};
    }
    return sweep;
}

}  // namespace surefoot::gate
