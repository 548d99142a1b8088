// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/footprints.hpp"

#include <algorithm>

namespace surefoot::gate {
namespace {

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

/// An edge of a polygon, counter-clockwise.
struct Edge {
    grid::FixedPoint from;
    grid::FixedPoint to;
};
Edge edge_of(const grid::FixedConvex& polygon, int i) noexcept {
    const int next = i + 1 < polygon.count ? i + 1 : 0;
    return {polygon.vertices[static_cast<std::size_t>(i)],
            polygon.vertices[static_cast<std::size_t>(next)]};
}

grid::FixedConvex hull_of(const Corners& a, const Corners& b) noexcept {
    std::array<grid::FixedPoint, 8> points{};
    std::copy(a.begin(), a.end(), points.begin());
    std::copy(b.begin(), b.end(), points.begin() + 4);
    return grid::convex_hull(points);
}

/// Returns the hull of a box at two poses, widened by a margin.
grid::FixedConvex swept(const GroundBox& box,
                        const FixedPose& start,
                        const FixedPose& target,
                        std::int64_t margin) noexcept {
    return hull_of(corners_of(box, start, margin), corners_of(box, target, margin));
}

/// Returns the edges of `here` beyond which `there` reaches by more than about a millimetre.
std::uint32_t edges_left(const grid::FixedConvex& here, const Corners& there) noexcept {
    constexpr std::int64_t kRounding = 10;
    std::uint32_t edges = 0;
    for (int i = 0; i < here.count; ++i) {
        const auto& [a, b] = edge_of(here, i);
        const std::int64_t size = grid::magnitude(b.x - a.x) + grid::magnitude(b.y - a.y);
        for (const grid::FixedPoint& corner : there) {
            if (grid::cross(a, b, corner) < -kRounding * size)
                edges |= std::uint32_t{1} << static_cast<unsigned>(i);
        }
    }
    return edges;
}

PartSweep part_sweep(const GroundBox& box,
                     const FixedPose& start,
                     const FixedPose& target,
                     std::int64_t margin) noexcept {
    PartSweep sweep;
    sweep.way = swept(box, start, target, margin);
    sweep.here = grid::convex_hull(corners_of(box, start, margin));
    sweep.leaves = edges_left(sweep.here, corners_of(box, target, margin));
    return sweep;
}

/// Returns the rear and the front half of a box that is widened by kAroundTenthMm.
std::array<grid::FixedConvex, 2> halves_of(const GroundBox& box, const FixedPose& pose) noexcept {
    GroundBox half = box;
    half.width_tenth_mm += 2 * kAroundTenthMm;
    half.length_tenth_mm = box.length_tenth_mm / 2 + kAroundTenthMm;
    const auto at = [&](std::int32_t forward) {
        half.center_x_tenth_mm = box.center_x_tenth_mm + forward;
        return grid::convex_hull(corners_of(half, pose, 0));
    };
    return {at(-half.length_tenth_mm / 2), at(half.length_tenth_mm / 2)};
}

FootSweep foot_sweep(Foot foot,
                     const GroundBox& box,
                     const GateLimits& limits,
                     const FixedPose& start,
                     const FixedPose& target,
                     std::int64_t margin) noexcept {
    FootSweep sweep;
    sweep.foot = foot;
    sweep.stance = grid::convex_hull(corners_of(box, start, 0));
    sweep.halves = halves_of(box, start);
    sweep.landing = grid::convex_hull(corners_of(box, target, 0));
    sweep.landing_center = to_odom(target, box.center_x_tenth_mm, box.center_y_tenth_mm);
    const std::int64_t corridor = limits.foot_margin_tenth_mm + margin;
    sweep.corridor = swept(box, start, target, corridor + kBesideTenthMm);
    const std::int64_t band = limits.drop_band_tenth_mm + margin;
    sweep.band = grid::convex_hull(corners_of(box, target, band + kBesideTenthMm));
    sweep.edges = grid::convex_hull(corners_of(box, target, band + kSmearTenthMm));
    return sweep;
}

}  // namespace

FixedPose fixed_pose(std::int64_t x_tenth_mm,
                     std::int64_t y_tenth_mm,
                     double cos_yaw,
                     double sin_yaw) noexcept {
    return {{x_tenth_mm, y_tenth_mm}, fraction(cos_yaw), fraction(sin_yaw)};
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

bool PartSweep::stays_in(std::int64_t ix,
                         std::int64_t iy,
                         const grid::FixedGrid& grid) const noexcept {
    const std::int64_t x = grid.origin_x + ix * grid.side;
    const std::int64_t y = grid.origin_y + iy * grid.side;
    const Corners cell{
        {{x, y}, {x + grid.side, y}, {x + grid.side, y + grid.side}, {x, y + grid.side}}};
    for (int i = 0; i < here.count; ++i) {
        if ((leaves >> static_cast<unsigned>(i) & 1U) == 0) continue;
        const auto& [a, b] = edge_of(here, i);
        for (const grid::FixedPoint& corner : cell) {
            if (grid::cross(a, b, corner) < 0) return false;
        }
    }
    return true;
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
        for (const grid::FixedConvex& half : foot.halves) include(half);
        include(foot.corridor);
        include(foot.edges);
    }
    for (const PartSweep& part : sweep.body) include(part.way);
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
    sweep.start = start;
    sweep.target = moved(start, movement);
    sweep.feet = {
        foot_sweep(
            Foot::left, machine.left_foot, machine.limits, start, sweep.target, margin_tenth_mm),
        foot_sweep(
            Foot::right, machine.right_foot, machine.limits, start, sweep.target, margin_tenth_mm)};
    std::size_t part = 0;
    for (const auto& [box, low, high] : machine.body.all()) {
        const std::int64_t margin = machine.body.sway_tenth_mm + kBesideTenthMm + margin_tenth_mm;
        sweep.body[part++] = part_sweep(box, start, sweep.target, margin);
    }
    return sweep;
}

}  // namespace surefoot::gate
