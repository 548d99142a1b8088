// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/safety_oracle/safety_testing.hpp"

namespace surefoot::sim {
namespace {

using namespace testing;
using Eigen::Vector2d;

/// One random hazard near the next step. It is drawn once, so that the same hazard can be built
/// rotated, mirrored or larger.
struct Hazard {
    enum class Kind { block, pit, hanging, wall } kind = Kind::block;
    Vector2d x;
    Vector2d y;
    double height_m = 0.0;
};

Hazard draw(Rng& rng) {
    Hazard hazard;
    hazard.kind = static_cast<Hazard::Kind>(rng.below(4));
    const double x_m = rng.uniform(-0.9, 1.1);
    const double y_m = rng.uniform(-0.7, 0.7);
    hazard.x = {x_m, x_m + rng.uniform(0.03, 0.5)};
    hazard.y = {y_m, y_m + rng.uniform(0.03, 0.5)};
    hazard.height_m = rng.uniform(0.005, 0.20);
    return hazard;
}

/// Sunk ground consists of slabs around the hole, so that it can be rotated. `larger` >= 1 makes a
/// block higher, a pit deeper, a hanging object lower, a wall longer.
void build(World& world, const Hazard& hazard, double larger = 1.0) {
    const Vector2d far(-3.0, 3.0);
    const double size_m = larger * hazard.height_m;
    const Vector2d &x = hazard.x, &y = hazard.y;
    if (hazard.kind != Hazard::Kind::pit) world.box(far, far, {-1.0, 0.0});
    switch (hazard.kind) {
        case Hazard::Kind::block: world.box(x, y, {0.0, size_m}); break;
        case Hazard::Kind::hanging: world.box(x, y, {2.2 - 2.0 * size_m, 2.5}); break;
        case Hazard::Kind::wall: world.box({x[0], x[0] + larger * 0.3}, y, {0.0, 2.0}); break;
        case Hazard::Kind::pit:
            world.box({far[0], x[0]}, far, {-1.0, 0.0}).box({x[1], far[1]}, far, {-1.0, 0.0});
            world.box(x, {far[0], y[0]}, {-1.0, 0.0}).box(x, {y[1], far[1]}, {-1.0, 0.0});
            world.box(x, y, {-1.0, -size_m});
            break;
    }
}

/// Dangers as a bit mask.
unsigned bits(const SafetyAnswer& answer) {
    unsigned all = 0;
    for (const Finding& f : answer.dangers) all |= 1U << static_cast<unsigned>(f.danger);
    return all;
}

int mirrored(int command) {
    switch (command) {
        case 11: return 23;
        case 23: return 11;
        case kLeft: return kRight;
        case kRight: return kLeft;
        case kTurnLeft: return kTurnRight;
        case kTurnRight: return kTurnLeft;
        default: return command;
    }
}

TEST(SafetyPropertyTest, AMirroredWorldHasTheMirroredAnswer) {
    Rng rng(11);
    int unsafe = 0;
    constexpr int kWorlds = 80;
    for (int k = 0; k < kWorlds; ++k) {
        const Hazard hazard = draw(rng);
        const int command = kCommands[rng.below(kCommands.size())];
        World world;
        build(world, hazard);
        World mirror(PlanarPose{}, true);
        build(mirror, hazard);
        const Pose T = standing(0.0, 0.0, 0.0);
        const auto a = judge(world.scene, testing::rex(), T, command);
        const auto b = judge(mirror.scene, testing::rex(), T, mirrored(command));
        EXPECT_EQ(bits(a), bits(b)) << "world " << k << " command " << command << "\n"
                                    << a.sentence() << "\n"
                                    << b.sentence();
        EXPECT_EQ(a.clear_cut, b.clear_cut) << "world " << k;
        unsafe += a.safe ? 0 : 1;
    }
    EXPECT_GT(unsafe, kWorlds / 5);
    EXPECT_LT(unsafe, kWorlds * 4 / 5);
}

TEST(SafetyPropertyTest, TurningTheWorldAndTheMachineTogetherChangesNothing) {
    Rng rng(12);
    for (int k = 0; k < 80; ++k) {
        const Hazard hazard = draw(rng);
        const int command = kCommands[rng.below(kCommands.size())];
        const double yaw = rng.uniform(-3.1, 3.1);
        const double x_m = rng.uniform(-2.0, 2.0);
        const double y_m = rng.uniform(-2.0, 2.0);
        World world;
        build(world, hazard);
        World turned(PlanarPose::of(x_m, y_m, yaw));
        build(turned, hazard);
        const auto a = judge(world.scene, testing::rex(), standing(0.0, 0.0, 0.0), command);
        const auto b = judge(turned.scene, testing::rex(), standing(x_m, y_m, yaw), command);
        EXPECT_EQ(bits(a), bits(b)) << "world " << k << " command " << command << "\n"
                                    << a.sentence() << "\n"
                                    << b.sentence();
        EXPECT_EQ(a.clear_cut, b.clear_cut) << "world " << k;
    }
}

TEST(SafetyPropertyTest, ALargerHazardIsNeverSafer) {
    Rng rng(13);
    int became_unsafe = 0;
    for (int k = 0; k < 80; ++k) {
        Hazard hazard = draw(rng);
        // Ahead of where the machine stands: ground under its feet is what heights count from.
        const double ahead_m = 0.25 - hazard.x[0];
        if (ahead_m > 0.0) hazard.x.array() += ahead_m;
        World small;
        build(small, hazard);
        World large;
        build(large, hazard, 1.0 + rng.uniform(0.05, 4.0));
        const int command = kCommands[rng.below(kCommands.size())];
        const auto a = judge(small.scene, testing::rex(), standing(0.0, 0.0, 0.0), command);
        const auto b = judge(large.scene, testing::rex(), standing(0.0, 0.0, 0.0), command);
        EXPECT_TRUE(a.safe || !b.safe) << "world " << k << " command " << command << "\n"
                                       << a.sentence() << "\n"
                                       << b.sentence();
        became_unsafe += a.safe && !b.safe ? 1 : 0;
    }
    EXPECT_GT(became_unsafe, 2);
}

/// A clear-cut answer holds for all poses within the margin, not only for the poses that `judge`
/// tries.
TEST(SafetyPropertyTest, AClearCutAnswerHoldsAroundThePose) {
    Rng rng(14);
    int asked = 0;
    for (int k = 0; k < 60; ++k) {
        World world;
        build(world, draw(rng));
        const int command = kCommands[rng.below(kCommands.size())];
        const auto a = judge(world.scene, testing::rex(), standing(0.0, 0.0, 0.0), command);
        if (!a.clear_cut) continue;
        ++asked;
        const Pose near = standing(
            rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004));
        const auto b = judge(world.scene, testing::rex(), near, command);
        EXPECT_EQ(a.safe, b.safe) << "world " << k << "\n" << a.sentence() << "\n" << b.sentence();
    }
    EXPECT_GT(asked, 30);
}

}  // namespace
}  // namespace surefoot::sim
