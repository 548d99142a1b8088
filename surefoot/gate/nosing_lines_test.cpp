// SPDX-License-Identifier: Apache-2.0
// Cells beside the line of a nosing count with the height of the side on which a region lies.
#include "surefoot/gate/nosing_lines.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr std::int64_t kSigma = 20;  // 2 mm
constexpr std::int64_t kReach = 69;  // 3.4 sigma, rounded up
constexpr std::int32_t kLower = 0;
constexpr std::int32_t kUpper = 1'800;

/// A line through a cell of the map, and a square region at some distance from it.
struct Line {
    OnTreads on;
    double yaw_rad = 0.0;  ///< direction towards the upper ground

    explicit Line(double yaw) : yaw_rad(yaw) {
        grid::SnapshotEdge& edge = on.map->edges[0];
        const auto at = [&](double left) {
            return std::array{static_cast<std::int32_t>(std::lround(-left * std::sin(yaw_rad))),
                              static_cast<std::int32_t>(std::lround(left * std::cos(yaw_rad)))};
        };
        const auto from_origin_x = static_cast<std::int32_t>(kX - on.map->origin_x_tenth_mm);
        const auto from_origin_y = static_cast<std::int32_t>(kY - on.map->origin_y_tenth_mm);
        const auto from = at(5'000.0);  // seen from here, the lower ground lies on the right
        const auto to = at(-5'000.0);
        edge = {from_origin_x + from[0],
                from_origin_y + from[1],
                from_origin_x + to[0],
                from_origin_y + to[1],
                kUpper,
                kLower,
                5,
                static_cast<std::int32_t>(kSigma)};
        on.map->edge_count = 1;
        on.look();
    }
    /// A square of 0.2 m whose nearest side lies at `away` before the line (negative: beyond it).
    [[nodiscard]] grid::FixedConvex region(double away) const {
        const double sign = away > 0.0 ? -1.0 : 1.0;
        const double near = -away;
        std::array<grid::FixedPoint, 4> corners{};
        std::size_t i = 0;
        for (const double along : {near, near + sign * 2'000.0})
            for (const double left : {-1'000.0, 1'000.0}) corners[i++] = point(along, left);
        return grid::convex_hull(corners);
    }
    [[nodiscard]] grid::FixedPoint point(double along, double left) const {
        return {kX + std::lround(along * std::cos(yaw_rad) - left * std::sin(yaw_rad)),
                kY + std::lround(along * std::sin(yaw_rad) + left * std::cos(yaw_rad))};
    }
    /// The cell that contains a point, with a height.
    [[nodiscard]] std::optional<std::int64_t> height_of(double along,
                                                        std::int64_t height,
                                                        const grid::FixedConvex& region,
                                                        std::int64_t widened = 0,
                                                        std::int32_t drift = 0,
                                                        double left = 0.0) const {
        const grid::FixedPoint p = point(along, left);
        GroundCell cell;
        cell.knowledge = Knowledge::measured;
        cell.height_tenth_mm = height;
        cell.sigma_tenth_mm = 100;
        cell.drift_tenth_mm = drift;
        const NosingLines lines(*on.ground, on.machine.limits, region, widened);
        const std::int64_t side = on.ground->grid().side;
        const bool changed = lines.sharpen(grid::floor_div(p.x - on.map->origin_x_tenth_mm, side),
                                           grid::floor_div(p.y - on.map->origin_y_tenth_mm, side),
                                           cell);
        EXPECT_EQ(cell.sigma_tenth_mm, changed ? 5 : 100);
        if (!changed) return std::nullopt;
        return cell.height_tenth_mm;
    }

    static constexpr std::int64_t kX = 3'140;  // in the middle of a cell's side
    static constexpr std::int64_t kY = 1'370;
};

constexpr std::array kYaws{0.0, 0.3, 0.785, 1.571, 2.5, -1.0, -2.9};

TEST(NosingLines, a_cell_on_the_line_counts_with_the_side_of_the_region) {
    for (const double yaw : kYaws) {
        const Line line(yaw);
        for (const std::int64_t height : {0, 600, 1'800}) {
            EXPECT_EQ(line.height_of(0.0, height, line.region(100.0)), kLower) << yaw;
            EXPECT_EQ(line.height_of(0.0, height, line.region(-100.0)), kUpper) << yaw;
            EXPECT_EQ(line.height_of(0.0, height, line.region(0.0)), std::nullopt) << yaw;
        }
        // Cells of the other side count so too; cells of the region's own side keep their height.
        EXPECT_EQ(line.height_of(400.0, 1'800, line.region(100.0)), kLower) << yaw;
        EXPECT_EQ(line.height_of(-500.0, 1'800, line.region(100.0)), std::nullopt) << yaw;
        EXPECT_EQ(line.height_of(-400.0, 0, line.region(-100.0)), kUpper) << yaw;
        EXPECT_EQ(line.height_of(500.0, 0, line.region(-100.0)), std::nullopt) << yaw;
    }
}

TEST(NosingLines, the_region_keeps_its_sigmas_from_the_line) {
    for (const double yaw : kYaws) {
        const Line line(yaw);
        constexpr double kRounded = 2.0;  // corners are rounded to 0.1 mm
        for (const double sign : {1.0, -1.0}) {
            const auto changes = [&](double away, std::int64_t widened, std::int32_t drift) {
                return line.height_of(0.0, 600, line.region(sign * away), widened, drift)
                    .has_value();
            };
            EXPECT_TRUE(changes(kReach + kRounded, 0, 0)) << yaw;
            EXPECT_FALSE(changes(kReach - kRounded, 0, 0)) << yaw;
            EXPECT_TRUE(changes(kReach - 50 + kRounded, 50, 0)) << yaw;
            EXPECT_FALSE(changes(kReach - 50 - kRounded, 50, 0)) << yaw;
            EXPECT_TRUE(changes(2 * kReach + kRounded, 0, kSigma)) << yaw;
            EXPECT_FALSE(changes(2 * kReach - kRounded, 0, kSigma)) << yaw;
        }
    }
}

TEST(NosingLines, what_is_higher_or_lower_than_both_grounds_keeps_its_height) {
    const Line line(0.3);
    const std::int64_t tolerance = line.on.machine.limits.patch_residual_tenth_mm;
    for (const double away : {100.0, -100.0}) {
        const auto region = line.region(away);
        EXPECT_TRUE(line.height_of(0.0, kUpper + tolerance, region));
        EXPECT_FALSE(line.height_of(0.0, kUpper + tolerance + 1, region));
        EXPECT_TRUE(line.height_of(0.0, kLower - tolerance, region));
        EXPECT_FALSE(line.height_of(0.0, kLower - tolerance - 1, region));
    }
    // A worn nosing.
    EXPECT_TRUE(line.height_of(0.0, 1'700, line.region(-100.0)));
    EXPECT_FALSE(line.height_of(0.0, 1'699, line.region(-100.0)));
    EXPECT_FALSE(line.height_of(0.0, 901, line.region(-100.0)));
    EXPECT_TRUE(line.height_of(0.0, 900, line.region(-100.0)));
    EXPECT_TRUE(line.height_of(0.0, 1'500, line.region(100.0)));
}

TEST(NosingLines, end_where_the_line_ends) {
    const Line line(0.0);
    const auto region = line.region(100.0);
    EXPECT_TRUE(line.height_of(0.0, 600, region, 0, 0, 4'700.0));
    EXPECT_FALSE(line.height_of(0.0, 600, region, 0, 0, 5'300.0));
    EXPECT_TRUE(line.height_of(0.0, 600, region, 0, 0, -4'700.0));
    EXPECT_FALSE(line.height_of(0.0, 600, region, 0, 0, -5'300.0));
}

TEST(NosingLines, a_line_of_a_small_step_or_with_impossible_numbers_does_not_count) {
    for (const int kind : {0, 1, 2, 3}) {
        Line line(0.0);
        grid::SnapshotEdge& edge = line.on.map->edges[0];
        if (kind == 1) edge.upper_tenth_mm = line.on.machine.limits.drop_tenth_mm;
        if (kind == 2) edge.across_sigma_tenth_mm = -1;
        if (kind == 3) edge.from_x_tenth_mm = 1'000'001;
        line.on.look();
        EXPECT_EQ(line.height_of(0.0, 300, line.region(100.0)).has_value(), kind == 0) << kind;
    }
}

TEST(NosingLines, a_foot_that_hangs_over_its_nosing_still_stands_on_its_tread) {
    // The feet reach 0.126 m behind and 0.240 m ahead of base_link.
    Terrain terrain;
    terrain.box(-2.0, -0.05, -2.0, 2.0, -0.18);
    const auto map = terrain.snapshot();
    Machine machine = rex();
    machine.limits.step[1] = {true, 1'800, 1'800};
    machine.movements[kForward].movement_class = MovementClass::stair;
    const Query query = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    const Sweep sweep = sweep_of(machine, FixedPose{}, machine.movements[kForward]);
    const Ground ground(*map, query, machine.limits);
    const Stance stance = find_stance(ground, query, sweep, true);
    EXPECT_EQ(stance.plane.height_tenth_mm, 0);
    EXPECT_EQ(stance.feet_tenth_mm[0], 0);
    Findings findings;
    machine.ankle_from_heel_tenth_mm = 1'260;
    check_stance_on_treads({machine, machine.movements[kForward], ground, sweep, stance}, findings);
    EXPECT_TRUE(findings.reasons().empty());
    machine.ankle_from_heel_tenth_mm = 600;  // the ankle hangs over
    check_stance_on_treads({machine, machine.movements[kForward], ground, sweep, stance}, findings);
    EXPECT_TRUE(findings.reasons().contains(Reason::drop_off));
}

}  // namespace
}  // namespace surefoot::gate::testing
