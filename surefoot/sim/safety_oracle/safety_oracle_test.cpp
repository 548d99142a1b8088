// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/sim/safety_oracle/safety_testing.hpp"

namespace surefoot::sim {
namespace {

using namespace testing;
using Eigen::Vector2d;

constexpr double deg(double angle_deg) {
    return angle_deg * std::numbers::pi / 180.0;
}

SafetyAnswer ask(const World& world, int command, const Pose& T = standing(0.0, 0.0, 0.0)) {
    return judge(world.scene, testing::rex(), T, command);
}

Finding first(const SafetyAnswer& answer) {
    EXPECT_FALSE(answer.dangers.empty()) << "thought safe";
    return answer.dangers.empty() ? Finding{} : answer.dangers.front();
}

TEST(SafetyOracleTest, EveryMovementOnAWideFlatFloorIsSafeAndClearCut) {
    const World world = World().floor();
    for (const int command : kCommands) {
        for (const double yaw : {0.0, 0.7, -2.5}) {
            const auto answer = ask(world, command, standing(0.3, -0.2, yaw));
            EXPECT_TRUE(answer.safe) << command << ": " << answer.sentence();
            EXPECT_TRUE(answer.clear_cut) << command;
            EXPECT_TRUE(answer.dangers.empty());
        }
    }
}

TEST(SafetyOracleTest, CodesThatTheMachineDoesNotHaveAreRefused) {
    const World world = World().floor();
    Machine machine = testing::rex();
    machine.movements[1].movement_class = MovementClass::stair;  // this class is switched off
    for (const int command : {-1, 0, 1, 2, 24, 27, 255}) {
        const auto answer = judge(world.scene, machine, standing(0.0, 0.0, 0.0), command);
        EXPECT_FALSE(answer.safe) << command;
        EXPECT_TRUE(answer.has(Danger::unknown_command)) << command;
        EXPECT_EQ(answer.sentence(),
                  "not safe: the machine has no such movement, or its class is disabled");
    }
}

TEST(SafetyOracleTest, NothingIsSafeWithoutGroundOrWithoutAPose) {
    EXPECT_TRUE(ask(World(), kForward).has(Danger::no_stance));
    const World floor = World().floor();
    Pose nan = standing(0.0, 0.0, 0.0);
    nan.translation_m.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(ask(floor, kForward, nan).has(Danger::unknown_pose));
    EXPECT_TRUE(ask(floor, kForward, standing(0.0, 0.0, 0.0, 0.3)).has(Danger::no_stance));
    EXPECT_TRUE(ask(floor, kForward, standing(0.0, 0.0, 0.0, 0.1)).safe);
}

/// A kerb of 75 mm is lower than the body's edge: only the feet meet it, 20 mm of margin included.
TEST(SafetyOracleTest, AKerbMattersExactlyWhenTheFootReachesIt) {
    const double foot_m = kStep_m + kToe_m;
    const double margin_m = foot_m + 0.020;
    for (const double at_m :
         {0.30, 0.50, foot_m - 0.006, foot_m + 0.006, margin_m - 0.006, margin_m + 0.006, 0.80}) {
        const World world = World().floor().box({at_m, 3.0}, {-2.0, 2.0}, {0.0, 0.075});
        const auto answer = ask(world, kForward);
        EXPECT_EQ(answer.has(Danger::step_up), at_m < foot_m) << at_m << answer.sentence();
        EXPECT_EQ(answer.has(Danger::obstacle_in_way), at_m < margin_m) << at_m;
        EXPECT_EQ(answer.safe, at_m > margin_m) << at_m;
        EXPECT_TRUE(ask(world, kBack).safe) << at_m;
        if (at_m < foot_m) {
            EXPECT_EQ(first(answer).danger, Danger::step_up);
            EXPECT_NEAR(first(answer).value, 0.075, 1e-9);
            EXPECT_EQ(first(answer).limit, 0.02);
            EXPECT_GE(first(answer).where_m.x(), at_m - 1e-9);
        }
    }
}

TEST(SafetyOracleTest, AnEdgeIsDangerousUnderTheFootAndInsideTheBandBeforeIt) {
    const double toe_m = kStep_m + kToe_m;
    const auto platform = [&](double beyond_m) {
        return World().floor(-0.17).box({-3.0, toe_m + beyond_m}, {-3.0, 3.0}, {-0.17, 0.0});
    };
    const auto half = ask(platform(-0.18), kForward);
    EXPECT_EQ(first(half).danger, Danger::drop_off) << half.sentence();
    EXPECT_NEAR(first(half).value, 0.17, 1e-9);
    EXPECT_TRUE(half.clear_cut);
    for (const double beyond_m : {0.05, 0.09}) {
        const auto answer = ask(platform(beyond_m), kForward);
        ASSERT_EQ(answer.dangers.size(), 1U) << answer.sentence();
        EXPECT_EQ(first(answer).danger, Danger::edge_too_near);
        EXPECT_GE(first(answer).value, beyond_m);
        EXPECT_LE(first(answer).value, beyond_m + kSpacing_m + 1e-9);
        EXPECT_EQ(answer.clear_cut, beyond_m == 0.05);
    }
    const auto far = ask(platform(0.11), kForward);
    EXPECT_TRUE(far.safe) << far.sentence();
    EXPECT_FALSE(far.clear_cut);
    EXPECT_TRUE(ask(platform(0.14), kForward).clear_cut);
    // A step just below the drop limit may be near; a step just above it may not.
    const auto ledge = [&](double down_m) {
        return World().floor(-down_m).box({-3.0, toe_m + 0.03}, {-3.0, 3.0}, {-down_m, 0.0});
    };
    EXPECT_TRUE(ask(ledge(0.049), kForward).safe);
    EXPECT_TRUE(ask(ledge(0.051), kForward).has(Danger::edge_too_near));
    // Depth counts from where the foot landed, here a little higher than it stood.
    for (const double plateau_m : {0.005, 0.015}) {
        World world;
        world.floor(-0.04).box({-3.0, 0.25}, {-3.0, 3.0}, {-0.04, 0.0});
        world.box({0.25, toe_m + 0.03}, {-3.0, 3.0}, {-0.04, plateau_m});
        EXPECT_EQ(ask(world, kForward).safe, plateau_m < 0.01) << plateau_m;
    }
}

TEST(SafetyOracleTest, TheEndOfTheWorldIsAnEdge) {
    World world;
    world.box({-3.0, 0.69}, {-3.0, 3.0}, {-0.5, 0.0});
    EXPECT_TRUE(ask(world, kForward).has(Danger::edge_too_near));
    World shorter;
    shorter.box({-3.0, 0.5}, {-3.0, 3.0}, {-0.5, 0.0});
    EXPECT_TRUE(ask(shorter, kForward).has(Danger::no_ground));
    EXPECT_TRUE(ask(shorter, kBack).safe);
}

TEST(SafetyOracleTest, APitBetweenTheFeetIsAnEdgeOfBoth) {
    const Pit pit{{{0.35, -0.05}, {0.60, 0.05}}, 0.3};
    const auto answer = ask(World().floor(0.0, {pit}), kForward);
    ASSERT_EQ(answer.dangers.size(), 1U) << answer.sentence();
    EXPECT_EQ(first(answer).danger, Danger::edge_too_near);
    EXPECT_NEAR(first(answer).value, 0.085 - 0.05, kSpacing_m + 1e-9);
    const Pit shallow{pit.area, 0.04};
    EXPECT_TRUE(ask(World().floor(0.0, {shallow}), kForward).safe);
}

TEST(SafetyOracleTest, ATableStopsTheBodyAlthoughTheFloorUnderItIsFree) {
    // Body: 0.33 + 0.05 of sway before base_link, 0.4 of way.
    const auto table = [](double from_m) {
        return World().floor().box({from_m, 3.0}, {-0.7, 0.7}, {0.69, 0.72});
    };
    const auto near = ask(table(0.77), kForward);
    ASSERT_EQ(near.dangers.size(), 1U) << near.sentence();
    EXPECT_EQ(first(near).danger, Danger::body_hits);
    EXPECT_NEAR(first(near).value, 0.69, 1e-9);
    EXPECT_TRUE(ask(table(0.786), kForward).safe);
    EXPECT_TRUE(ask(table(0.77), kBack).safe);
    EXPECT_TRUE(ask(table(0.77), kLeft).safe);
}

TEST(SafetyOracleTest, ABeamIsTooLowUnderTheHeightOfTheUser) {
    const auto beam = [](double underside_m) {
        return World().floor().box({0.6, 0.8}, {-2.0, 2.0}, {underside_m, underside_m + 0.3});
    };
    const auto low = ask(beam(2.045), kForward);
    ASSERT_EQ(low.dangers.size(), 1U) << low.sentence();
    EXPECT_EQ(first(low).danger, Danger::overhang_too_low);
    EXPECT_NEAR(first(low).value, 2.045, 1e-9);
    EXPECT_DOUBLE_EQ(first(low).limit, 2.05);
    EXPECT_FALSE(low.clear_cut);
    EXPECT_TRUE(ask(beam(1.5), kForward).clear_cut);
    EXPECT_TRUE(ask(beam(2.06), kForward).safe);
}

TEST(SafetyOracleTest, AThingThatHangsLowStopsTheFoot) {
    // Below the body's edge, so only where the foot passes; its top is above that edge.
    const World world = World().floor().box({0.5, 0.6}, {0.1, 0.2}, {0.10, 0.50});
    EXPECT_TRUE(ask(world, kForward).has(Danger::obstacle_in_way));
    EXPECT_TRUE(ask(world, kForward).has(Danger::body_hits));
}

TEST(SafetyOracleTest, ARampUnderTheMachineIsJudgedByItsSlopeAlone) {
    for (const double slope_deg : {-7.0, -5.0, 3.0, 5.0, 7.0}) {
        for (const double heading_deg : {0.0, 90.0, 30.0}) {
            World world(PlanarPose::of(0.0, 0.0, deg(heading_deg)));
            world.slab({-3.0, 3.0}, {-3.0, 3.0}, -2.0, {std::tan(deg(slope_deg)), 0.0});
            const auto answer = ask(world, kForward);
            EXPECT_EQ(answer.safe, std::abs(slope_deg) < 6.0)
                << slope_deg << " deg towards " << heading_deg << ": " << answer.sentence();
            if (answer.safe) continue;
            EXPECT_TRUE(answer.has(Danger::not_level_here));
            EXPECT_TRUE(answer.has(Danger::tilt));
            EXPECT_NEAR(first(answer).value, std::abs(slope_deg), 0.01);
        }
    }
}

TEST(SafetyOracleTest, ASteepRampAheadTiltsTheLandingFoot) {
    // Begins 40 mm before the heels of the landing feet and is too low there to count as a step.
    World world;
    world.floor().slab({0.42, 3.0}, {-2.0, 2.0}, -1.0, {0.11, 0.0}, -0.11 * 0.42);
    const auto answer = ask(world, kForward);
    EXPECT_TRUE(answer.has(Danger::step_up)) << answer.sentence();
    World roof;  // up and down within the step limits, steeper than 6 deg across the foot
    roof.floor().slab({0.2, 0.7}, {0.10, 0.275}, -1.0, {0.0, 0.113}, -0.0113);
    const auto across = ask(roof, kForward);
    EXPECT_TRUE(across.has(Danger::tilt)) << across.sentence();
    EXPECT_FALSE(across.has(Danger::step_up)) << across.sentence();
}

TEST(SafetyOracleTest, CrossFallOfOneInFiftyIsSafeEverywhere) {
    World world;
    world.slab({-3.0, 3.0}, {-3.0, 3.0}, -1.0, {0.0, 0.02});
    for (const int command : kCommands) {
        const auto answer = ask(world, command);
        EXPECT_TRUE(answer.safe && answer.clear_cut) << command << ": " << answer.sentence();
    }
}

TEST(SafetyOracleTest, SillsAreSafeUpToTheStepLimit) {
    for (const double sill_m : {0.006, 0.013, 0.020, 0.021, 0.030, 0.045}) {
        const World world = World().floor().box({0.45, 0.51}, {-0.5, 0.5}, {0.0, sill_m});
        const auto answer = ask(world, kForward);
        EXPECT_EQ(answer.safe, sill_m <= 0.020) << sill_m << ": " << answer.sentence();
        EXPECT_EQ(answer.has(Danger::step_up), sill_m > 0.020) << sill_m;
        EXPECT_EQ(answer.has(Danger::obstacle_in_way), sill_m > 0.040) << sill_m;
        EXPECT_EQ(answer.clear_cut, sill_m < 0.018 || sill_m > 0.022) << sill_m;
    }
}

TEST(SafetyOracleTest, AShallowStepDownIsNamedAsSuch) {
    const auto ledge = [](double down_m) {
        return World().floor(-down_m).box({-3.0, 0.25}, {-3.0, 3.0}, {-down_m, 0.0});
    };
    EXPECT_TRUE(ask(ledge(0.019), kForward).safe);
    const auto answer = ask(ledge(0.03), kForward);
    EXPECT_EQ(first(answer).danger, Danger::step_down) << answer.sentence();
    EXPECT_NEAR(first(answer).value, 0.03, 1e-9);
    EXPECT_EQ(first(ask(ledge(0.06), kForward)).danger, Danger::drop_off);
}

TEST(SafetyOracleTest, RoughGroundIsJudgedByPatchesWhereStepsAreAllowed) {
    Machine machine = testing::rex();
    machine.movements[kForward].movement_class = MovementClass::stair;
    machine.limits.step[1].enabled = true;
    // A block under the middle of each foot, 50 mm wide and as high as stairs may be.
    const auto blocks = [](double z_m) {
        return World().floor().box({0.43, 0.485}, {-0.3, 0.3}, {0.0, z_m});
    };
    const Pose T = standing(0.0, 0.0, 0.0);
    EXPECT_TRUE(judge(blocks(0.02).scene, machine, T, kForward).safe);
    const auto answer = judge(blocks(0.06).scene, machine, T, kForward);
    EXPECT_TRUE(answer.has(Danger::roughness)) << answer.sentence();
    EXPECT_FALSE(answer.has(Danger::step_up));
}

/// The body is 0.645 + 2 * 0.05 = 0.745 m wide with its sway; it looks along the wall and steps
/// sideways through the door, 0.66 + 2 * 0.05 = 0.76 m long.
TEST(SafetyOracleTest, SidewaysThroughADoorNeedsRoomForTheSwayingBody) {
    const auto door = [](double width_m) {
        return World()
            .floor()
            .box({-3.0, -0.5 * width_m}, {-0.6, -0.5}, {0.0, 2.6})
            .box({0.5 * width_m, 3.0}, {-0.6, -0.5}, {0.0, 2.6})
            .box({-3.0, 3.0}, {-0.6, -0.5}, {2.06, 2.6});
    };
    const Pose in_door = standing(0.0, -0.45, 0.0);
    const auto wide = ask(door(0.90), kRight, in_door);
    EXPECT_TRUE(wide.safe && wide.clear_cut) << wide.sentence();
    const auto narrow = ask(door(0.76), kRight, in_door);
    EXPECT_FALSE(narrow.clear_cut) << narrow.sentence();  // fits to the millimetre
    const auto beside = ask(door(0.76), kRight, standing(0.02, -0.45, 0.0));
    EXPECT_TRUE(beside.has(Danger::body_hits)) << beside.sentence();
    EXPECT_TRUE(ask(door(0.72), kRight, in_door).has(Danger::body_hits));
}

TEST(SafetyOracleTest, TurningBesideAWallSweepsTheCorners) {
    const auto wall = [](double y_m) {
        return World().floor().box({-3.0, 3.0}, {y_m, y_m + 0.2}, {0.0, 2.6});
    };
    // Left side after 15 deg to the left: 0.3725 cos 15 + 0.38 sin 15 = 0.4582 m.
    EXPECT_TRUE(ask(wall(0.40), kTurnLeft).has(Danger::body_hits));
    EXPECT_TRUE(ask(wall(0.45), kTurnLeft).has(Danger::body_hits));
    EXPECT_TRUE(ask(wall(0.466), kTurnLeft).safe) << ask(wall(0.466), kTurnLeft).sentence();
    EXPECT_TRUE(ask(wall(0.40), kForward).safe);
    EXPECT_TRUE(ask(wall(0.45), kTurnRight).has(Danger::body_hits));
    EXPECT_TRUE(ask(wall(0.36), kForward).has(Danger::body_hits));  // at the start already
}

TEST(SafetyOracleTest, AnIslandOfGoodGroundIsCutOff) {
    Machine machine = testing::rex();
    machine.movements[kForward].forward_tenth_mm = 7'000;
    // A trench across the whole way, farther than the band from the feet after a long step.
    const Pit trench{{{0.30, -3.0}, {0.45, 3.0}}, 0.3};
    const auto answer =
        judge(World().floor(0.0, {trench}).scene, machine, standing(0.0, 0.0, 0.0), kForward);
    EXPECT_TRUE(answer.has(Danger::disconnected)) << answer.sentence();
    const Pit hole{{{0.30, -0.3}, {0.45, 0.1}}, 0.3};  // the machine can walk round the hole
    const auto around =
        judge(World().floor(0.0, {hole}).scene, machine, standing(0.0, 0.0, 0.0), kForward);
    EXPECT_FALSE(around.has(Danger::disconnected)) << around.sentence();
}

TEST(SafetyOracleTest, FeetAtTwoHeightsAreNoStance) {
    const auto under_left_foot = [](double z_m) {
        return World().floor().box({-1.0, 2.0}, {0.0, 1.0}, {0.0, z_m});
    };
    EXPECT_TRUE(ask(under_left_foot(0.03), kForward).has(Danger::no_stance));
    EXPECT_TRUE(ask(under_left_foot(0.018), kForward).safe);
    const World hanging = World().box({-2.0, 0.2}, {-1.0, 1.0}, {-1.0, 0.0});
    EXPECT_TRUE(ask(hanging, kBack).has(Danger::no_stance));
}

TEST(SafetyOracleTest, AnotherStoreyIsToldApartByTheHeightOfThePose) {
    const World world = World().floor().box({-3.0, 3.0}, {-3.0, 3.0}, {2.5, 2.8});
    EXPECT_TRUE(ask(world, kForward).safe);
    EXPECT_TRUE(ask(world, kForward, standing(0.0, 0.0, 0.0, 2.8)).safe);
}

TEST(SafetyOracleTest, ManyAnswersAreTheSameOnTwoThreadsAndInOrder) {
    const World world = World().floor().box({0.9, 2.0}, {-0.5, 0.5}, {0.0, 0.1});
    const std::vector<Pose> poses{standing(0.0, 0.0, 0.0), standing(0.4, 0.1, 0.3)};
    Serial serial;
    Threads two(2);
    const auto a = judge_all(world.scene, testing::rex(), poses, kCommands, serial);
    const auto b = judge_all(world.scene, testing::rex(), poses, kCommands, two);
    ASSERT_EQ(a.size(), poses.size() * kCommands.size());
    std::vector<SafetyLabel> from_a;
    std::vector<SafetyLabel> from_b;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const int command = kCommands[k % kCommands.size()];
        from_a.push_back({static_cast<std::int64_t>(k), command, a[k]});
        from_b.push_back({static_cast<std::int64_t>(k), command, b[k]});
        EXPECT_EQ(a[k].sentence(), ask(world, command, poses[k / kCommands.size()]).sentence());
    }
    EXPECT_EQ(safety_csv(from_a), safety_csv(from_b));
}

TEST(SafetyOracleTest, LabelsBecomeLinesOfText) {
    SafetyAnswer safe;
    safe.safe = safe.clear_cut = true;
    SafetyAnswer not_safe;
    not_safe.dangers = {{Danger::step_up, 0.075, 0.02, {1.0, -0.25, 0.075}},
                        {Danger::obstacle_in_way, 0.075, 0.04, {1.0, 0.0, 0.075}}};
    const std::vector<SafetyLabel> labels{{1'500'000'000, 9, safe}, {2'000'000'007, 13, not_safe}};
    EXPECT_EQ(safety_csv(labels),
              "time_s,command,safe,clear_cut,dangers,value,limit,x_m,y_m,z_m\n"
              "1.500000000,9,1,1,,,,,,\n"
              "2.000000007,13,0,0,step_up|obstacle_in_way,0.075000,0.020000,1.0000,-0.2500,"
              "0.0750\n");
    EXPECT_EQ(safety_csv({}), "time_s,command,safe,clear_cut,dangers,value,limit,x_m,y_m,z_m\n");
}

}  // namespace
}  // namespace surefoot::sim
