// SPDX-License-Identifier: Apache-2.0
// The drift since a cell was seen.
#include <gtest/gtest.h>

#include <tuple>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, given_too_much_drift_since_a_cell_was_seen_then_memory_uncertain) {
    Terrain floor;
    floor.drift.fill(0.024F);
    expect_ok(ask(floor, kBackward));
    floor.paint(floor.drift, -0.4, -0.3, -0.3, 0.3, 0.03);
    const Verdict verdict = ask(floor, kBackward);
    expect_refused(verdict, Reason::memory_uncertain);
    EXPECT_EQ(verdict.evidence.value_tenth_mm, 300);
    floor.drift.fill(kNanF);
    expect_refused(ask(floor, kForward), Reason::memory_uncertain);
}

TEST(Gate, what_drifted_may_stand_nearer_than_the_map_says) {
    // Body and sway reach 0.40 m to the side; 3.4 sigma of the drift beyond 10 mm are 48 mm.
    for (const auto& [drift_m, y_m, allowed] : {std::tuple{0.010, 0.40, true},
                                                {0.024, 0.40, false},
                                                {0.024, 0.425, false},
                                                {0.024, 0.45, true}}) {
        Terrain wall;
        wall.box(-3.0, 3.0, y_m, 3.0, 0.8);
        wall.drift.fill(static_cast<float>(drift_m));
        const Verdict verdict = ask(wall, kForward);
        EXPECT_EQ(verdict.decision == Decision::ok, allowed) << drift_m << " " << y_m;
        if (!allowed) expect_refused(verdict, Reason::body_clearance);
    }
    // The drifted cell need not be the obstacle.
    Terrain wall;
    wall.box(-3.0, 3.0, 0.425, 3.0, 0.8);
    wall.paint(wall.drift, 0.4, 0.425, -0.1, -0.075, 0.024);
    expect_refused(ask(wall, kForward), Reason::body_clearance);
}

}  // namespace
}  // namespace surefoot::gate::testing
