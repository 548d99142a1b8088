// SPDX-License-Identifier: Apache-2.0
// The machine that the tests of the gate share (gate_testing.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {

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
    expect_problem([](Machine& m) { m.body.count = 0; }, "no body");
    expect_problem([](Machine& m) { m.body.count = Body::kMaxParts + 1; }, "nine parts");
    expect_problem([](Machine& m) { m.body.count = -1; }, "fewer than none");
    expect_problem([](Machine& m) { m.body.count = 2; }, "a part without a size");
    expect_problem([](Machine& m) { m.body.parts[0].low_tenth_mm = 0; }, "body on the ground");
    expect_problem([](Machine& m) { m.body.parts[0].high_tenth_mm = 1440; }, "flat body");
    expect_problem([](Machine& m) { m.body.sway_tenth_mm = -1; }, "negative sway");
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
    expect_problem([](Machine& m) { m.limits.tread_share_permille = 400; },
                   "less than half a foot");
    expect_problem([](Machine& m) { m.limits.tread_share_permille = 1100; }, "more than a foot");
    expect_problem([](Machine& m) { m.limits.tread_overhang_tenth_mm = 1100; }, "long overhang");
    expect_problem([](Machine& m) { m.ankle_from_heel_tenth_mm = -1; }, "ankle behind the heel");
    expect_problem([](Machine& m) { m.ankle_from_heel_tenth_mm = 3700; }, "ankle before the toes");
}

}  // namespace surefoot::gate::testing
