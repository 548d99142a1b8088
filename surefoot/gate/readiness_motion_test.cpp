// SPDX-License-Identifier: Apache-2.0
// How far and how fast a machine can move between two frames.
#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/gate/readiness.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Readiness, a_walk_is_no_jump_and_the_bounds_hold_both_ways) {
    const ReadinessLimits limits;
    const double reach_m = limits.fastest_m_s * seconds_from_ns(kFrameNs) + limits.jump_m;
    const double turn_rad = limits.fastest_rad_s * seconds_from_ns(kFrameNs) + limits.jump_rad;
    for (const double share : {0.98, 1.02}) {
        for (const int direction : {0, 1, 2, 3, 4}) {
            Station station;
            station.become_ready();
            const auto step = static_cast<std::int64_t>(std::llround(share * reach_m * 1e4));
            if (direction == 0) station.map->body_x_tenth_mm += step;
            if (direction == 1) station.map->body_y_tenth_mm -= step;
            if (direction == 4) {  // the ground moves too; otherwise it is not under the soles
                station.map->body_z_tenth_mm += step;
                station.map->height_tenth_mm.fill(static_cast<std::int32_t>(step));
            }
            if (direction == 2 || direction == 3) {
                const double yaw_rad = share * turn_rad * (direction == 2 ? 1.0 : -1.0);
                station.map->body_cos_yaw = std::cos(yaw_rad);
                station.map->body_sin_yaw = std::sin(yaw_rad);
            }
            station.frame();
            EXPECT_EQ(station.readiness.state(), share < 1.0 ? GateState::ready : GateState::fault)
                << "direction " << direction;
        }
    }
    Station about;
    about.become_ready();
    about.map->body_cos_yaw = -1.0;  // sin is 0 as for no turn at all
    about.frame();
    EXPECT_EQ(about.readiness.state(), GateState::fault);
}

TEST(Readiness, after_a_long_gap_any_heading_is_possible_and_not_any_place) {
    const auto after_s = [](double gap_s, double yaw_rad, std::int64_t shift_tenth_mm) {
        Station station;
        station.become_ready();
        station.now_ns += static_cast<std::int64_t>(gap_s * 1e9) - kFrameNs;
        station.map->body_cos_yaw = std::cos(yaw_rad);
        station.map->body_sin_yaw = std::sin(yaw_rad);
        station.map->body_x_tenth_mm += shift_tenth_mm;
        station.frame();
        return station.readiness.state();
    };
    // 0.0524 rad + 1.5708 rad/s: 1.5 rad after 0.9216 s.
    EXPECT_EQ(after_s(0.90, 1.40, 0), GateState::ready);
    EXPECT_EQ(after_s(0.90, 2.50, 0), GateState::fault);
    EXPECT_EQ(after_s(0.95, 2.50, 0), GateState::ready);
    // 0.05 m + 1 m/s.
    EXPECT_EQ(after_s(0.95, 0.0, 9'990), GateState::ready);
    EXPECT_EQ(after_s(0.95, 0.0, 10'010), GateState::fault);
    EXPECT_EQ(after_s(0.50, 0.3, 5'490), GateState::ready);
    EXPECT_EQ(after_s(0.50, 0.3, 5'510), GateState::fault);
}

TEST(Readiness, a_turn_counts_from_the_heading_before) {
    for (const double before_rad : {0.7, 2.4, -2.4}) {
        for (const double turn_rad : {0.15, -0.15, 0.165, -0.165}) {  // 0.1571 rad within 1/15 s
            Station station;
            const auto look = [&station](double yaw_rad) {
                station.map->body_cos_yaw = std::cos(yaw_rad);
                station.map->body_sin_yaw = std::sin(yaw_rad);
            };
            look(before_rad);
            station.become_ready();
            ASSERT_EQ(station.readiness.state(), GateState::ready);
            look(before_rad + turn_rad);
            station.frame();
            EXPECT_EQ(station.readiness.state(),
                      std::abs(turn_rad) < 0.157 ? GateState::ready : GateState::fault)
                << before_rad << " " << turn_rad;
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
