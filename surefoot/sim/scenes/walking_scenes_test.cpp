// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "surefoot/sim/motion/motion_scripts.hpp"
#include "surefoot/sim/motion/rex_kinematics.hpp"
#include "surefoot/sim/motion/rex_plan.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/safety_oracle/safety_testing.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

/// Compares the embedded walks with the safety oracle: every scene is dangerous where and why its
/// description says.
namespace surefoot::sim {
namespace {

constexpr std::uint64_t kSeeds = 3;

/// The REX with all its sectors.
Machine walking_rex() {
    Machine machine = testing::rex();
    const auto tenth_mm = [](double m) { return static_cast<std::int32_t>(std::lround(1e4 * m)); };
    for (const RexMovement& movement : rex_movements({})) {
        Movement& known = machine.movements[static_cast<std::size_t>(movement.command)];
        known.configured = true;
        known.forward_tenth_mm = tenth_mm(movement.forward_m);
        known.left_tenth_mm = tenth_mm(movement.left_m);
        known.cos_turn = std::cos(movement.turn_rad);
        known.sin_turn = std::sin(movement.turn_rad);
    }
    return machine;
}

/// A scene and the truth about each of its steps.
struct Walk {
    Walk(const std::string& name, std::uint64_t seed) : scene(make_scene(name, seed).value()) {
        static const Machine machine = walking_rex();
        for (const StepEvent& step : scene.steps)
            answers.push_back(judge(scene.scene, machine, step.T_world_before, step.command));
        where = name + " seed " + std::to_string(seed);
    }
    [[nodiscard]] double parameter(const std::string& name) const {
        for (const SceneParameter& drawn : scene.parameters) {
            if (drawn.name == name) return std::stod(drawn.value);
        }
        ADD_FAILURE() << where << " has no parameter " << name;
        return 0.0;
    }
    /// All steps but the last `count` are safe, and these are not.
    void expect_only_the_last_unsafe(std::size_t count) const {
        ASSERT_GT(answers.size(), count) << where;
        for (std::size_t i = 0; i < answers.size(); ++i) {
            EXPECT_EQ(answers[i].safe, i + count < answers.size())
                << where << " step " << i + 1 << ": " << answers[i].sentence();
        }
    }

    ScriptedScene scene;
    std::vector<SafetyAnswer> answers;
    std::string where;
};

TEST(WalkingScenesTest, OnFreeGroundEveryStepIsSafe) {
    for (const char* name : {"walk_floor",
                             "walk_turn_round",
                             "walk_back_to_table",
                             "walk_sidestep_door_1000",
                             "walk_pivot_reverse",
                             "walk_look_pivot_reverse",
                             "walk_look_pivot_reverse_edge"}) {
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
            Walk(name, seed).expect_only_the_last_unsafe(0);
    }
}

TEST(WalkingScenesTest, TheLastStepBackHitsTheTableThatStandsNearer) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Walk walk("walk_back_into_table", seed);
        walk.expect_only_the_last_unsafe(1);
        EXPECT_EQ(walk.answers.back().dangers.front().danger, Danger::body_hits) << walk.where;
        // The lower side of the board.
        EXPECT_NEAR(walk.answers.back().dangers.front().value, walk.parameter("top_m") - 0.03, 1e-6)
            << walk.where;
    }
}

TEST(WalkingScenesTest, ADoorAsNarrowAsTheMachineIsDeepIsHitByTheBodyAlone) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Walk walk("walk_sidestep_door_760", seed);
        int hits = 0;
        for (std::size_t i = 0; i < walk.answers.size(); ++i) {
            for (const Finding& finding : walk.answers[i].dangers) {
                EXPECT_EQ(finding.danger, Danger::body_hits) << walk.where << " step " << i + 1;
                EXPECT_EQ(walk.scene.steps[i].command / 4, 21 / 4) << "sideways: 20 to 22";
                EXPECT_NEAR(finding.where_m.x(), walk.parameter("door_x_m"), 0.08) << walk.where;
                ++hits;
            }
        }
        EXPECT_GE(hits, 5) << walk.where;
    }
}

/// A foot is longer than a tread and than a backward step: before the machine can step down, its
/// heels stand over the edge.
TEST(WalkingScenesTest, SteppingBackOntoATreadIsADropForTheHeels) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Walk walk("walk_descend_backwards", seed);
        const double rise_m = walk.parameter("rise_m");
        const double edge_m = descending_edge_x_m(static_cast<int>(walk.parameter("steps_ahead")));
        EXPECT_EQ(walk.scene.scene.height_at(edge_m - 1e-6, 0.0)->z_m, 0.0) << walk.where;
        EXPECT_NEAR(walk.scene.scene.height_at(edge_m + 1e-6, 0.0)->z_m, -rise_m, 1e-9)
            << walk.where;
        walk.expect_only_the_last_unsafe(2);
        const SafetyAnswer& to_the_brink = walk.answers[walk.answers.size() - 2];
        EXPECT_EQ(to_the_brink.dangers.front().danger, Danger::drop_off) << walk.where;
        EXPECT_NEAR(to_the_brink.dangers.front().value, rise_m, 1e-3) << walk.where;
        const SafetyAnswer& down = walk.answers.back();
        EXPECT_TRUE(down.has(Danger::not_level_here)) << walk.where << down.sentence();
        EXPECT_TRUE(down.has(Danger::drop_off)) << walk.where << down.sentence();
        EXPECT_NEAR(
            walk.scene.steps.back().T_world_after.translation_m.z(), rex::kStand_m - rise_m, 1e-9)
            << walk.where;
    }
}

TEST(WalkingScenesTest, ReversingToAnEdgeIsSafeUntilTheHeelsAreOverIt) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Walk walk("walk_pivot_reverse_edge", seed);
        walk.expect_only_the_last_unsafe(1);
        EXPECT_EQ(walk.answers.back().dangers.front().danger, Danger::drop_off) << walk.where;
        EXPECT_NEAR(walk.answers.back().dangers.front().value, 0.15, 1e-3) << walk.where;
    }
}

/// Only the first step onto a ramp is a step in height; after it the tilt of the ramp counts.
TEST(WalkingScenesTest, ARampIsASafeWayWhereTheMachineMayStand) {
    for (const auto& [name, slope] :
         {std::pair("walk_ramp_1_12", 1.0 / 12.0), {"walk_ramp_1_8", 1.0 / 8.0}}) {
        const bool flat_enough = slope < std::tan(6.0 * std::numbers::pi / 180.0);
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const Walk walk(name, seed);
            ASSERT_EQ(walk.answers.size(), 5U) << walk.where;
            EXPECT_TRUE(walk.answers[0].safe) << walk.where;
            EXPECT_TRUE(walk.answers[1].safe) << walk.where;
            EXPECT_EQ(walk.answers[2].dangers.front().danger, Danger::step_up) << walk.where;
            for (const std::size_t on_ramp : {3U, 4U}) {
                EXPECT_EQ(walk.answers[on_ramp].safe, flat_enough) << walk.where;
                EXPECT_EQ(walk.answers[on_ramp].has(Danger::not_level_here), !flat_enough)
                    << walk.where;
            }
            // The sole's middle is 57 mm ahead of base_link.
            const auto& end_m = walk.scene.steps.back().T_world_after.translation_m;
            EXPECT_NEAR(end_m.z() - rex::kStand_m,
                        slope * (end_m.x() + 0.057 - walk.parameter("foot_x_m")),
                        1e-3)
                << walk.where;
        }
    }
}

TEST(WalkingScenesTest, AHandTakesNoSteps) {
    const ScriptedScene scene = make_scene("hand_held", 1).value();
    EXPECT_EQ(scene.script.motion_model, MotionModel::hand);
    EXPECT_TRUE(scene.steps.empty());
    EXPECT_LT(scene.motion->duration_s(), 30.0);
}

TEST(WalkingScenesTest, AnotherMotionModelGoesTheSameWayThroughTheSamePlace) {
    const ScriptedScene driven = make_scene("kerb_down_100", 3).value();
    const ScriptedScene walked = make_scene("kerb_down_100", 3, MotionModel::rex).value();
    const ScriptedScene carried = make_scene("kerb_down_100", 3, MotionModel::hand).value();
    EXPECT_TRUE(driven.steps.empty());
    EXPECT_TRUE(carried.steps.empty());
    EXPECT_FALSE(walked.steps.empty());
    EXPECT_EQ(walked.parameters, driven.parameters);
    const auto end_x_m = [](const ScriptedScene& scene) {
        return scene.motion->at(scene.motion->duration_s()).T_world_body.translation_m.x();
    };
    EXPECT_NEAR(end_x_m(walked), end_x_m(driven), 0.25);  // whole steps
    EXPECT_NEAR(end_x_m(carried), end_x_m(driven), 0.1);
    EXPECT_GT(walked.motion->duration_s(), 3.0 * driven.motion->duration_s());
    EXPECT_FALSE(make_scene("walk_descend_backwards", 3, MotionModel::trolley).ok());
}

}  // namespace
}  // namespace surefoot::sim
