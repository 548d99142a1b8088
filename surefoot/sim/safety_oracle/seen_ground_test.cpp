// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/seen_ground.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/executor.hpp"
#include "surefoot/sim/safety_oracle/safety_testing.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

using namespace testing;

constexpr std::int64_t kStepBack_ns = 1'000'000'000;

/// The camera looks from 1 m behind the machine, then (a second later) from the machine itself.
SceneTruth approach(Scene scene) {
    SceneTruth truth;
    truth.scene = std::move(scene);
    truth.rig = rig_preset("zed_vga").value();
    truth.trajectory = {{0, standing(-1.0, 0.0, 0.0)}, {kStepBack_ns, standing(0.0, 0.0, 0.0)}};
    return truth;
}

bool is_seen(const SceneTruth& truth,
             int command,
             std::int64_t until_ns = kStepBack_ns,
             const VouchedGround& vouched = {}) {
    Serial serial;
    const Machine machine = testing::rex();
    const SeenGround seen(truth, until_ns, machine, {0.0, 0.0}, 0.0, serial);
    return seen.holds_zone(machine, standing(0.0, 0.0, 0.0), command, vouched);
}

TEST(SeenGround, HoldsTheZoneThatTheCamerasSawOnTheWay) {
    const SceneTruth truth = approach(std::move(World().floor().scene));
    EXPECT_TRUE(is_seen(truth, kForward));
    EXPECT_TRUE(is_seen(truth, kForward, 0)) << "the first frame alone sees it";
    EXPECT_FALSE(is_seen(truth, kForward, -1)) << "no frame is old enough";
    SceneTruth from_here = truth;
    from_here.trajectory.erase(from_here.trajectory.begin());
    EXPECT_FALSE(is_seen(from_here, kForward)) << "the machine cannot see the ground at its feet";
}

TEST(SeenGround, OneHiddenPlaceInTheZoneIsEnoughToMissIt) {
    // The box hides 0.1 m of floor behind it, on the way of the left foot.
    const SceneTruth hidden =
        approach(std::move(World().floor().box({0.3, 0.35}, {0.15, 0.2}, {0.0, 0.1}).scene));
    EXPECT_FALSE(is_seen(hidden, kForward));
    // The same box ahead of the zone hides nothing of it.
    const SceneTruth ahead =
        approach(std::move(World().floor().box({0.8, 0.85}, {0.15, 0.2}, {0.0, 0.1}).scene));
    EXPECT_TRUE(is_seen(ahead, kForward));
}

TEST(SeenGround, AnOperatorVouchesForThePlacesInTheDisc) {
    SceneTruth truth = approach(std::move(World().floor().scene));
    truth.trajectory.erase(truth.trajectory.begin());
    constexpr double kReach_m = 1.0;  // holds the whole zone
    EXPECT_TRUE(is_seen(truth, kForward, kStepBack_ns, {{0.0, 0.0}, kReach_m}));
    EXPECT_FALSE(is_seen(truth, kForward, kStepBack_ns, {{0.0, 0.0}, 0.3}));
    EXPECT_FALSE(is_seen(truth, kForward, kStepBack_ns, {{3.0, 0.0}, kReach_m}));
}

TEST(SeenGround, TheBodyNeedsOnlyTheGroundThatItEnters) {
    const SceneTruth truth = approach(std::move(World().floor().scene));
    Serial serial;
    const Machine machine = testing::rex();
    const Pose here = standing(0.0, 0.0, 0.0);
    const SeenGround seen(truth, kStepBack_ns, machine, {0.0, 0.0}, 0.0, serial);
    EXPECT_TRUE(seen.holds_body(machine, here, kForward, {}));
    EXPECT_FALSE(seen.holds_body(machine, here, kBack, {})) << "never in view from x = -1";
    EXPECT_TRUE(seen.holds_body(machine, here, kBack, {{0.0, 0.0}, 1.0}));
    Machine still = machine;
    still.movements[kForward].forward_tenth_mm = 0;
    SceneTruth blind = truth;
    blind.trajectory.clear();
    EXPECT_TRUE(SeenGround(blind, kStepBack_ns, still, {0.0, 0.0}, 0.0, serial)
                    .holds_body(still, here, kForward, {}))
        << "the body fills its space itself";
}

TEST(SeenGround, NoMovementHasNoZone) {
    const SceneTruth truth = approach(std::move(World().floor().scene));
    for (const int command : {-1, 0, 2, 27}) EXPECT_FALSE(is_seen(truth, command)) << command;
}

}  // namespace
}  // namespace surefoot::sim
