// SPDX-License-Identifier: Apache-2.0
// Surfaces that are a step away.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>

#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// Two surfaces in the path of a foot: 1 is the present one, 2 begins `gap` cells beyond a strip of
/// 3.
struct Surfaces {
    OnTreads on;
    std::int64_t row = 0;
    std::int64_t column = 0;

    explicit Surfaces(double yaw_rad) {
        on.place(0, 0, yaw_rad);
        on.map->height_tenth_mm.fill(0);
        on.map->component.fill(0);
        const grid::FixedPoint middle = on.sweep.feet[0].landing_center;
        column = (middle.x - on.map->origin_x_tenth_mm) / 250;
        row = (middle.y - on.map->origin_y_tenth_mm) / 250;
    }
    void set(std::int64_t ix, std::int64_t iy, std::uint16_t component, std::int32_t height) {
        on.map->component[on.index(ix, iy)] = component;
        on.map->height_tenth_mm[on.index(ix, iy)] = height;
    }
    [[nodiscard]] bool joins(std::uint16_t component = 2) const {
        ReachableSurfaces reachable;
        reachable.add(1);
        add_a_step_away(on.scene(), reachable);
        return reachable.contains(component);
    }
};

TEST(TreadBounds, a_surface_is_a_step_away_within_two_cells_and_as_high_as_the_class_steps) {
    for (const bool across : {false, true}) {
        for (const std::int64_t cells : {1, 2, 3}) {
            for (const std::int64_t way : {-1, 1}) {
                Surfaces s(0.0);
                const std::int64_t dx = across ? 0 : way * cells;
                const std::int64_t dy = across ? way * cells : 0;
                const auto joined = [&](std::int32_t height) {
                    s.set(s.column, s.row, 1, 70);
                    s.set(s.column + dx, s.row + dy, 2, 70 + height);
                    return s.joins();
                };
                EXPECT_EQ(joined(0), cells <= 2) << across << cells << way;
                EXPECT_EQ(joined(1800), cells <= 2);
                EXPECT_FALSE(joined(1801));
                EXPECT_EQ(joined(-1800), cells <= 2);
                EXPECT_FALSE(joined(-1801));
            }
        }
    }
}

TEST(TreadBounds, up_and_down_have_limits_of_their_own) {
    Surfaces s(0.0);
    s.on.machine.limits.step[1] = {true, 1000, 500};
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 1000);
    EXPECT_TRUE(s.joins());
    s.set(s.column + 1, s.row, 2, -600);
    EXPECT_FALSE(s.joins());
    s.set(s.column + 1, s.row, 2, -500);
    EXPECT_TRUE(s.joins());
    // From the other side of the border: the present surface is the second cell.
    s.set(s.column, s.row, 2, -500);
    s.set(s.column + 1, s.row, 1, 0);
    EXPECT_TRUE(s.joins());
    s.set(s.column, s.row, 2, -501);
    EXPECT_FALSE(s.joins());
    s.set(s.column, s.row, 2, 1000);
    EXPECT_TRUE(s.joins());
    s.set(s.column, s.row, 2, 1001);
    EXPECT_FALSE(s.joins());
}

TEST(TreadBounds, one_step_is_added_and_no_flight) {
    Surfaces s(0.0);
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 1500);
    s.set(s.column + 2, s.row, 3, 3000);
    EXPECT_TRUE(s.joins(2));
    EXPECT_FALSE(s.joins(3));
}

TEST(TreadBounds, only_measured_ground_in_the_way_of_a_foot_is_a_step_away) {
    Surfaces s(0.3);
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 0);
    ASSERT_TRUE(s.joins());
    s.on.map->source[s.on.index(s.column + 1, s.row)] = grid::EvidenceSource::unknown;
    EXPECT_FALSE(s.joins());
    s.on.map->source[s.on.index(s.column + 1, s.row)] = grid::EvidenceSource::measured;
    s.on.map->source[s.on.index(s.column, s.row)] = grid::EvidenceSource::unknown;
    EXPECT_FALSE(s.joins());
    s.on.map->source[s.on.index(s.column, s.row)] = grid::EvidenceSource::measured;
    // Every cell of the corridor: a pair counts if both cells lie in it.
    s.set(s.column, s.row, 0, 0);
    s.set(s.column + 1, s.row, 0, 0);
    std::set<std::size_t> way;
    s.on.each_cell(s.on.sweep.feet[0].corridor,
                   [&](std::int64_t ix, std::int64_t iy) { way.insert(s.on.index(ix, iy)); });
    std::set<std::size_t> other;
    s.on.each_cell(s.on.sweep.feet[1].corridor,
                   [&](std::int64_t ix, std::int64_t iy) { other.insert(s.on.index(ix, iy)); });
    for (std::int64_t iy = s.row - 15; iy <= s.row + 15; ++iy) {
        for (std::int64_t ix = s.column - 30; ix <= s.column + 15; ++ix) {
            for (const bool up : {false, true}) {
                const std::int64_t dx = up ? 0 : 1;
                const std::int64_t dy = up ? 1 : 0;
                const std::size_t a = s.on.index(ix, iy);
                const std::size_t b = s.on.index(ix + dx, iy + dy);
                s.set(ix, iy, 1, 0);
                s.set(ix + dx, iy + dy, 2, 0);
                EXPECT_EQ(s.joins(),
                          (way.contains(a) && way.contains(b)) ||
                              (other.contains(a) && other.contains(b)))
                    << ix << " " << iy;
                s.set(ix, iy, 0, 0);
                s.set(ix + dx, iy + dy, 0, 0);
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
