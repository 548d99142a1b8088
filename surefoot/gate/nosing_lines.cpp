// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/nosing_lines.hpp"

#include <algorithm>

namespace surefoot::gate {
namespace {

/// Largest depth of a cell below the upper ground at which it still counts as this ground.
constexpr std::int64_t kLevelTenthMm = 100;

/// Returns the square root, rounded up. Newton's method from above, in integers.
std::int64_t root_up(std::int64_t square) noexcept {
    if (square <= 1) return square;
    std::int64_t root = std::int64_t{1} << 32;
    while (true) {
        const std::int64_t next = (root + square / root) / 2;
        if (next >= root) break;
        root = next;
    }
    return root * root < square ? root + 1 : root;
}

}  // namespace

std::int64_t times_up(double factor, std::int64_t x) noexcept {
    // in range: see the precondition
    return std::max(x, static_cast<std::int64_t>(factor * static_cast<double>(x)) + 1);
}

bool is_nosing(const grid::SnapshotEdge& edge, const GateLimits& limits) noexcept {
    constexpr std::int64_t kFarthest = 1'000'000;  // 100 m
    const auto within = [](std::int64_t x) { return x >= -kFarthest && x <= kFarthest; };
    return within(edge.from_x_tenth_mm) && within(edge.from_y_tenth_mm) &&
           within(edge.to_x_tenth_mm) && within(edge.to_y_tenth_mm) &&
           edge.across_sigma_tenth_mm >= 0 && edge.height_sigma_tenth_mm >= 0 &&
           edge.upper_tenth_mm - std::int64_t{edge.lower_tenth_mm} > limits.drop_tenth_mm;
}

NosingLines::NosingLines(const Ground& ground,
                         const GateLimits& limits,
                         const grid::FixedConvex& region,
                         std::int64_t widened_tenth_mm) noexcept
    : ground_(ground),
      sigma_factor_(limits.sigma_factor),
      tolerance_tenth_mm_(limits.patch_residual_tenth_mm) {
    const grid::FixedGrid& grid = ground.grid();
    for (const grid::SnapshotEdge& edge : ground.edges()) {
        if (!is_nosing(edge, limits)) continue;
        Line line;
        line.from = {edge.from_x_tenth_mm, edge.from_y_tenth_mm};
        line.to = {edge.to_x_tenth_mm, edge.to_y_tenth_mm};
        const std::int64_t dx = line.to.x - line.from.x;
        const std::int64_t dy = line.to.y - line.from.y;
        line.length_up = root_up(dx * dx + dy * dy);
        line.sigma_reach = times_up(limits.sigma_factor, edge.across_sigma_tenth_mm);
        // The upper ground lies on the left of the line, where `cross` is positive.
        std::int64_t low = INT64_MAX;
        std::int64_t high = INT64_MIN;
        for (const grid::FixedPoint& p : region.points()) {
            const std::int64_t distance =
                grid::cross(line.from, line.to, {p.x - grid.origin_x, p.y - grid.origin_y});
            low = std::min(low, distance);
            high = std::max(high, distance);
        }
        line.side = low + high > 0 ? Side::upper : Side::lower;
        line.away = (line.side == Side::upper ? low : -high) + widened_tenth_mm * line.length_up;
        if (line.away < line.sigma_reach * line.length_up) continue;
        line.lower_tenth_mm = edge.lower_tenth_mm;
        line.upper_tenth_mm = edge.upper_tenth_mm;
        line.height_sigma_tenth_mm = edge.height_sigma_tenth_mm;
        lines_[static_cast<std::size_t>(count_++)] = line;
    }
}

bool NosingLines::concerns(const Line& line,
                           std::int64_t ix,
                           std::int64_t iy,
                           const GroundCell& cell) const noexcept {
    if (cell.height_tenth_mm < line.lower_tenth_mm - tolerance_tenth_mm_ ||
        cell.height_tenth_mm > line.upper_tenth_mm + tolerance_tenth_mm_)
        return false;
    // A cell of the upper ground that is a little too low can be a worn nosing.
    const std::int64_t middle = (std::int64_t{line.lower_tenth_mm} + line.upper_tenth_mm) / 2;
    if (line.side == Side::upper && cell.height_tenth_mm > middle &&
        cell.height_tenth_mm < line.upper_tenth_mm - kLevelTenthMm)
        return false;
    const std::int64_t drift = times_up(sigma_factor_, cell.drift_tenth_mm);
    if (line.away < (line.sigma_reach + drift) * line.length_up) return false;
    const std::int64_t side = ground_.grid().side;
    const std::int64_t dx = line.to.x - line.from.x;
    const std::int64_t dy = line.to.y - line.from.y;
    // From the start of the line to the middle of the cell, doubled.
    const std::int64_t x = (2 * ix + 1) * side - 2 * line.from.x;
    const std::int64_t y = (2 * iy + 1) * side - 2 * line.from.y;
    const std::int64_t along = dx * x + dy * y;
    if (along < 0 || along > 2 * (dx * dx + dy * dy)) return false;
    const std::int64_t across = dx * y - dy * x;  // positive on the upper side
    const std::int64_t reach =
        (grid::magnitude(dx) + grid::magnitude(dy)) * side + 2 * line.sigma_reach * line.length_up;
    return line.side == Side::lower ? across >= -reach : across <= reach;
}

bool NosingLines::sharpen(std::int64_t ix, std::int64_t iy, GroundCell& cell) const noexcept {
    if (!cell.known()) return false;
    for (int i = 0; i < count_; ++i) {
        const Line& line = lines_[static_cast<std::size_t>(i)];
        if (!concerns(line, ix, iy, cell)) continue;
        const bool lower = line.side == Side::lower;
        cell.height_tenth_mm = lower ? line.lower_tenth_mm : line.upper_tenth_mm;
        cell.sigma_tenth_mm = line.height_sigma_tenth_mm;
        return true;
    }
    return false;
}

}  // namespace surefoot::gate
