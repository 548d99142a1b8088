// SPDX-License-Identifier: Apache-2.0
// The line of a nosing, which makes the end of a tread more certain.
#include <gtest/gtest.h>

#include <cstdint>

#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A line of the snapshot between two positions, both along and across a foot that faces +x, from
/// its middle [tenth_mm].
grid::SnapshotEdge line(const OnTreads& on,
                        std::int64_t from_along,
                        std::int64_t from_across,
                        std::int64_t to_along,
                        std::int64_t to_across) {
    const grid::FixedPoint middle = on.sweep.feet[0].landing_center;
    const auto x = [&](std::int64_t along) {
        return static_cast<std::int32_t>(middle.x + along - on.map->origin_x_tenth_mm);
    };
    const auto y = [&](std::int64_t across) {
        return static_cast<std::int32_t>(middle.y + across - on.map->origin_y_tenth_mm);
    };
    grid::SnapshotEdge edge;
    edge.from_x_tenth_mm = x(from_along);
    edge.from_y_tenth_mm = y(from_across);
    edge.to_x_tenth_mm = x(to_along);
    edge.to_y_tenth_mm = y(to_across);
    edge.lower_tenth_mm = -1500;
    return edge;
}

/// The certainly supported length of a foot, as stated by its refusal [doubled tenth_mm].
std::int64_t carried(const OnTreads& on, const Tread& tread) {
    const Findings findings = tread_findings(on, 0, tread);
    const Finding* worst = findings.worst(Reason::edge_margin);
    return worst == nullptr ? -1 : 2 * worst->value_tenth_mm;
}

/// The tread seems to end 100 tenth_mm before the toes; with 600 more it is too short.
struct Nosing {
    OnTreads on;
    Tread tread{true, 0, kNone, kNone, 0};
    std::int64_t length = 3660;

    explicit Nosing(bool at_toe) {
        on.map->height_tenth_mm.fill(0);
        on.machine.limits.tread_share_permille = 970;  // 3550 of 3660
        on.machine.ankle_from_heel_tenth_mm = 1830;
        on.look();
        (at_toe ? tread.toe_edge : tread.heel_edge) = length - 200;
    }
    void set(const grid::SnapshotEdge& edge) {
        on.map->edges[0] = edge;
        on.map->edge_count = 1;
        on.look();
    }
    [[nodiscard]] std::int64_t with(const grid::SnapshotEdge& edge) {
        set(edge);
        return carried(on, tread);
    }
};

TEST(TreadBounds, a_line_takes_back_doubt_to_the_tenth_of_a_millimetre) {
    for (const bool at_toe : {true, false}) {
        Nosing n(at_toe);
        const std::int64_t way = at_toe ? 1 : -1;
        EXPECT_EQ(carried(n.on, n.tread), 2 * n.length - 200 - 500 - 2);
        // 1630 along, a line whose only uncertainty is rounding; lower ground on its right.
        const auto at = [&](std::int64_t right_along, std::int64_t left_along, std::int64_t wide) {
            return at_toe ? line(n.on, right_along, -wide, left_along, wide)
                          : line(n.on, left_along, wide, right_along, -wide);
        };
        const auto straight = at(way * 1630, way * 1630, 2000);
        const std::int64_t with_line = n.length + 2 * 1630 - 2 - 2;
        EXPECT_EQ(n.with(straight), with_line);
        // A line that just spans the foot, and one that does not.
        EXPECT_EQ(n.with(at(way * 1630, way * 1630, 950)), with_line);
        const std::int64_t without = 2 * n.length - 200 - 500 - 2;
        auto shorter = at(way * 1630, way * 1630, 950);
        shorter.from_y_tenth_mm += at_toe ? 1 : -1;
        EXPECT_EQ(n.with(shorter), without);
        shorter = at(way * 1630, way * 1630, 950);
        shorter.to_y_tenth_mm += at_toe ? -1 : 1;
        EXPECT_EQ(n.with(shorter), without);
        // Slanted: where it crosses the nearer side of the foot, 950 of 2000 across.
        EXPECT_EQ(n.with(at(way * 1670, way * 1590, 2000)), n.length + 2 * 1611 - 4);
        EXPECT_EQ(n.with(at(way * 1590, way * 1670, 2000)), n.length + 2 * 1611 - 4);
        // Adds its sigma, times 3.4 and rounded up, on both sides.
        auto unsure = straight;
        unsure.across_sigma_tenth_mm = 10;
        EXPECT_EQ(n.with(unsure), with_line - 2 * 34);
        unsure.across_sigma_tenth_mm = 1'000;  // larger than a cell: the cell's value counts
        EXPECT_EQ(n.with(unsure), without);
        // Farther out than the cells: the cells decide.
        EXPECT_EQ(n.with(at(way * 1800, way * 1800, 2000)), -1);
        n.tread.drift_tenth_mm = 30;
        EXPECT_EQ(n.with(at(way * 1800, way * 1800, 2000)), 2 * n.length - 200 - 2 * 103);
        n.tread.drift_tenth_mm = 0;
    }
}

TEST(TreadBounds, a_line_is_this_nosing_at_its_height_and_with_a_drop_alone) {
    Nosing n(true);
    const std::int64_t without = carried(n.on, n.tread);
    const grid::SnapshotEdge straight = line(n.on, 1630, -2000, 1630, 2000);
    const std::int64_t with_line = n.with(straight);
    ASSERT_GT(with_line, without);
    const auto changed = [&](auto&& change) {
        grid::SnapshotEdge edge = straight;
        change(edge);
        return n.with(edge);
    };
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 251; }), without);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = -250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = -251; }), without);
    EXPECT_EQ(changed([](auto& e) { e.lower_tenth_mm = -501; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.lower_tenth_mm = -500; }), without);
    n.tread.rise_tenth_mm = 1500;
    n.on.query.stance_height_tenth_mm = 70;
    n.on.map->height_tenth_mm.fill(1570);
    EXPECT_EQ(changed([](auto&) {}), without);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 1570 + 250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 1570 + 251; }), without);
}

TEST(TreadBounds, the_ends_of_a_line_lie_within_a_hundred_metres) {
    Nosing n(true);
    const std::int64_t without = carried(n.on, n.tread);
    constexpr std::int32_t kFarthest = 1'000'000;
    const auto ends = [&](std::int32_t from_y, std::int32_t to_y) {
        grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
        edge.from_y_tenth_mm = from_y;
        edge.to_y_tenth_mm = to_y;
        return n.with(edge);
    };
    EXPECT_GT(ends(-kFarthest, kFarthest), without);
    EXPECT_EQ(ends(-kFarthest - 1, kFarthest), without);
    EXPECT_EQ(ends(-kFarthest, kFarthest + 1), without);
    // Along the foot: such a slanted line passes the same position on both sides of the foot.
    const auto along = [&](std::int32_t from_x, std::int32_t to_x) {
        grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
        edge.across_sigma_tenth_mm = 0;
        edge.from_x_tenth_mm = from_x;
        edge.to_x_tenth_mm = to_x;
        n.set(edge);
        return answer_of(tread_findings(n.on, 0, n.tread));
    };
    // Beyond the toes on both sides only if both ends are: such a line removes all uncertainty.
    EXPECT_EQ(along(kFarthest, kFarthest), Carried::whole);
    EXPECT_EQ(along(kFarthest + 1, kFarthest), Carried::unsure);
    EXPECT_EQ(along(kFarthest, kFarthest + 1), Carried::unsure);
    grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
    edge.across_sigma_tenth_mm = -1;
    EXPECT_EQ(n.with(edge), without);
}

TEST(TreadBounds, of_two_lines_the_nearer_counts) {
    Nosing n(true);
    for (const bool first_is_nearer : {true, false}) {
        n.set(line(n.on, 1630, -2000, 1630, 2000));
        const std::int64_t nearer = carried(n.on, n.tread);
        n.on.map->edges[0] =
            line(n.on, first_is_nearer ? 1630 : 1640, -2000, first_is_nearer ? 1630 : 1640, 2000);
        n.on.map->edges[1] =
            line(n.on, first_is_nearer ? 1640 : 1630, -2000, first_is_nearer ? 1640 : 1630, 2000);
        n.on.map->edge_count = 2;
        n.on.look();
        EXPECT_EQ(carried(n.on, n.tread), nearer);
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
