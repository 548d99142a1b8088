// SPDX-License-Identifier: Apache-2.0
// The machine and the look-up that the tests of the gate share (gate_testing.hpp).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {

Machine rex() {
    Machine m;
    m.sole_depth_tenth_mm = 9900;
    m.left_foot = {570, 1800, 3660, 1900};
    m.right_foot = {570, -1800, 3660, 1900};
    m.body = {{0, 0, 6600, 6450}, 500, 1440, 20500};
    const auto set = [&m](int code, int forward, int left, double turn_deg) {
        Movement& movement = m.movements[static_cast<std::size_t>(code)];
        movement.configured = true;
        movement.forward_tenth_mm = forward;
        movement.left_tenth_mm = left;
        movement.cos_turn = std::cos(turn_deg * std::numbers::pi / 180.0);
        movement.sin_turn = std::sin(turn_deg * std::numbers::pi / 180.0);
    };
    for (int sector = 0; sector < 16; ++sector) {
        const double angle = sector * std::numbers::pi / 8.0;  // clockwise from forward
        const double ahead = std::cos(angle) * (std::cos(angle) > 0.0 ? 4000.0 : 2500.0);
        const auto forward = static_cast<int>(std::lround(ahead));
        const auto left = static_cast<int>(std::lround(-1000.0 * std::sin(angle)));
        set(9 + sector, forward, left, 0.0);
        if (sector % 2 == 0) set(1 + sector / 2, forward / 2, left / 2, 0.0);
    }
    set(kTurnLeft, 0, 0, 15.0);
    set(kTurnRight, 0, 0, -15.0);
    GateLimits& l = m.limits;
    l.step[0] = {true, 200, 200};
    l.step[1] = {false, 1800, 1800};
    l.min_normal_z = std::cos(6.0 * std::numbers::pi / 180.0);
    l.patch_residual_tenth_mm = 250;
    l.patch_sigma_tenth_mm = 30;
    l.patch_independent_cells = 4;
    l.cell_sigma_tenth_mm = 120;
    l.swing_clearance_tenth_mm = 400;
    l.foot_margin_tenth_mm = 200;
    l.drop_tenth_mm = 500;
    l.drop_band_tenth_mm = 1000;
    l.drop_evidence = 128;
    l.drift_tenth_mm = 250;
    l.frame_age_ns = 200 * kMs;
    l.pose_age_ns = 200 * kMs;
    l.future_tolerance_ns = 5 * kMs;
    l.verdict_ttl_ns = 300 * kMs;
    l.vouch_radius_tenth_mm = 10000;
    return m;
}

std::size_t cell_at(const grid::MapSnapshot& map, double x_m, double y_m) {
    const auto ix = static_cast<std::int64_t>(std::floor(
        (x_m * 1e4 - static_cast<double>(map.origin_x_tenth_mm)) / map.resolution_tenth_mm));
    const auto iy = static_cast<std::int64_t>(std::floor(
        (y_m * 1e4 - static_cast<double>(map.origin_y_tenth_mm)) / map.resolution_tenth_mm));
    return static_cast<std::size_t>(iy * map.nx + ix);
}

TEST(Rex, is_a_valid_machine_and_each_broken_number_is_a_problem) {
    EXPECT_EQ(rex().problem(), nullptr) << rex().problem();
    EXPECT_NE(Machine{}.problem(), nullptr);
    const double nan = std::nan("");
    const auto expect_problem = [](auto break_it, const char* what) {
        Machine machine = rex();
        break_it(machine);
        EXPECT_NE(machine.problem(), nullptr) << what;
    };
    expect_problem([](Machine& m) { m.left_foot.length_tenth_mm = 0; }, "foot without length");
    expect_problem([](Machine& m) { m.left_foot.length_tenth_mm = 9000; }, "foot of 18 patches");
    expect_problem([](Machine& m) { m.movements[0].configured = true; }, "code 0");
    expect_problem([&](Machine& m) { m.movements[9].cos_turn = nan; }, "NaN turn");
    expect_problem([](Machine& m) { m.movements[9].cos_turn = -1.0; }, "half a turn");
    expect_problem([](Machine& m) { m.movements[9].forward_tenth_mm = 30'000; }, "3 m step");
    expect_problem([](Machine& m) { m.movements[9].name.fill('x'); }, "endless name");
    expect_problem([&](Machine& m) { m.limits.min_normal_z = nan; }, "NaN tilt");
    expect_problem([](Machine& m) { m.limits.min_normal_z = 0.5; }, "60 deg tilt");
    expect_problem([&](Machine& m) { m.limits.sigma_factor = nan; }, "NaN factor");
    expect_problem([](Machine& m) { m.limits.frame_age_ns = 0; }, "no frame age");
    expect_problem([](Machine& m) { m.limits.frame_age_ns = 2'000 * kMs; }, "frame age off");
    expect_problem([](Machine& m) { m.limits.drop_evidence = 0; }, "evidence off");
    expect_problem([](Machine& m) { m.limits.drop_band_tenth_mm = 0; }, "band off");
    expect_problem([](Machine& m) { m.limits.patch_sigma_tenth_mm = 0; }, "no patch sigma");
}

}  // namespace surefoot::gate::testing
