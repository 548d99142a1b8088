// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_motion.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "surefoot/sim/motion/motion_scripts.hpp"
#include "surefoot/sim/motion/rex_kinematics.hpp"
#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::sim {
namespace {

constexpr double kExact_m = 1e-9;

/// Line 5 is the motion, line 8 the first of `solids` after a floor.
std::string file_with(const std::string& motion, const std::string& solids = "") {
    return "name: test\n"
           "description: for a test\n"
           "parameters: {half_m: 0.6, three: 3}\n"
           "materials: {stone: {pattern: concrete}}\n"
           "motion: {" +
           motion +
           "}\n"
           "solids:\n"
           "  - floor: {min_x_m: -4, min_y_m: -4, max_x_m: 9, max_y_m: 4, material: stone}\n" +
           solids;
}

ScriptedScene read(const std::string& motion, const std::string& solids = "") {
    const std::string text = file_with(motion, solids);
    auto made = read_scene({"test.yaml", text}, "", 1);
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
}

std::string refusal(const std::string& motion, const std::string& solids = "") {
    const std::string text = file_with(motion, solids);
    const auto made = read_scene({"test.yaml", text}, "", 1);
    if (made) return "accepted";
    EXPECT_EQ(made.error().code, ErrorCode::input);
    return made.error().message;
}

TEST(SceneMotionTest, AFileNamesAScriptWithItsFigures) {
    const std::vector<std::pair<std::string, MotionScript>> motions{
        {"script: approach, motion_model: rex, distance_m: 2 * half_m",
         approach_script(MotionModel::rex, 1.2)},
        {"script: turn_round, motion_model: rex, turn_deg: -30 * three",
         turn_round_script(MotionModel::rex, -0.5 * 3.14159265358979323846)},
        {"script: back_to_table, motion_model: rex, table_x_m: 2.1, left_m: 0.9",
         back_to_table_script(MotionModel::rex, 2.1, 0.9)},
        {"script: sidestep_through_door, motion_model: hand, door_x_m: 1.4, door_y_m: -0.1, "
         "beyond_m: half_m",
         sidestep_through_door_script(MotionModel::hand, 1.4, -0.1, 0.6)},
        {"script: descend_backwards, motion_model: rex, steps_ahead: three - 1, riser_m: 0.17",
         descend_backwards_script(2, 0.17)},
        {"script: pivot_and_reverse, distance_m: 1",
         pivot_and_reverse_script(MotionModel::trolley, 1.0)}};
    const std::string flight =
        "  - floor: {min_x_m: -4, min_y_m: -4, max_x_m: 9, max_y_m: 4, z_m: -0.17, "
        "material: stone}\n";
    for (const auto& [text, expected] : motions) {
        const MotionScript script = read(text, flight).script;
        EXPECT_EQ(script.motion_model, expected.motion_model) << text;
        ASSERT_EQ(script.waypoints.size(), expected.waypoints.size()) << text;
        for (std::size_t i = 0; i < script.waypoints.size(); ++i) {
            const Waypoint& a = script.waypoints[i];
            const Waypoint& b = expected.waypoints[i];
            EXPECT_NEAR(a.x_m, b.x_m, kExact_m) << text << " waypoint " << i;
            EXPECT_NEAR(a.y_m, b.y_m, kExact_m) << text << " waypoint " << i;
            EXPECT_NEAR(a.yaw_rad, b.yaw_rad, kExact_m) << text << " waypoint " << i;
            EXPECT_EQ(a.ground_z_m, b.ground_z_m) << text << " waypoint " << i;
            EXPECT_EQ(a.move, b.move) << text << " waypoint " << i;
        }
    }
}

TEST(SceneMotionTest, SpeedAndMovesReachTheRex) {
    const ScriptedScene slow =
        read("script: approach, motion_model: rex, speed_m_s: 0.02, distance_m: 0.4");
    ASSERT_EQ(slow.steps.size(), 1U);
    EXPECT_NEAR(slow.steps[0].end_s - slow.steps[0].start_s, 20.0, kExact_m);
    const ScriptedScene back =
        read("motion_model: rex, waypoints: [{x_m: 0, y_m: 0}, {x_m: -0.5, y_m: 0, move: back}]");
    ASSERT_EQ(back.steps.size(), 2U);
    EXPECT_EQ(back.steps[0].command, 17) << "backward";
}

TEST(SceneMotionTest, TheFormerNameOfTheMotionModelIsRead) {
    const std::string way = "waypoints: [{x_m: 0, y_m: 0}, {x_m: -0.5, y_m: 0, move: back}]";
    EXPECT_EQ(read("carrier: rex, " + way).steps.size(), 2U);
    EXPECT_EQ(read("motion_model: rex, " + way).steps.size(), 2U);
    EXPECT_EQ(read(way).steps.size(), 0U) << "a trolley makes no steps";
}

TEST(SceneMotionTest, MistakesAreNamedWithFileLineValueAndLimit) {
    const std::vector<std::pair<std::string, std::string>> motions{
        {"motion_model: rex", "test.yaml:5: 'motion' needs 'waypoints' or 'script'"},
        {"script: approach, distance_m: 1, carrier: rex, motion_model: rex",
         "unknown key 'carrier'"},
        {"script: dance",
         "test.yaml:5: 'script' is 'dance'; it must be one of approach, turn_round, "},
        {"script: approach", "test.yaml:5: key 'distance_m' is missing"},
        {"script: approach, distance_m: 0", "'distance_m' is 0; it must be 0.1 to 100"},
        {"script: approach, distance_m: 1, turn_deg: 3", "unknown key 'turn_deg'"},
        {"script: approach, distance_m: 1, waypoints: [{x_m: 0, y_m: 0}]",
         "unknown key 'script'; known keys: motion_model, speed_m_s, height_m, waypoints"},
        {"script: approach, distance_m: far", "no number is named 'far'"},
        {"script: back_to_table, table_x_m: 1, left_m: 2", "left_m 2 must be at most table_x_m 1"},
        {"script: descend_backwards, riser_m: 0.1, motion_model: rex",
         "key 'steps_ahead' is missing"},
        {"script: descend_backwards, riser_m: 0.1, steps_ahead: 2, motion_model: hand",
         "script descend_backwards needs a walking machine: motion_model must be rex, not hand"},
        {"script: descend_backwards, riser_m: 0.3, steps_ahead: 2, motion_model: rex",
         "'riser_m' is 0.3; it must be 0 to 0.2"},
        {"script: approach, motion_model: rex, speed_m_s: 1, distance_m: 1",
         "cannot be followed: simulator: speed_m_s is 1; motion_model rex moves at 0.02 to 0.1"},
        {"waypoints: [{x_m: 0, y_m: 0, move: jump}]",
         "'move' is 'jump'; it must be one of auto, ahead, back, side"}};
    for (const auto& [motion, message] : motions) {
        const std::string said = refusal(motion);
        EXPECT_EQ(said.find("test.yaml:5: "), 0U) << said;
        EXPECT_NE(said.find(message), std::string::npos) << said << "\nshould say: " << message;
    }
}

const std::string kTwoSteps = "script: approach, motion_model: rex, distance_m: 0.8";

double last_z_m(const ScriptedScene& scene) {
    return scene.steps.back().T_world_after.translation_m.z();
}

TEST(SceneMotionTest, FeetStandOnTheGroundOfTheScene) {
    const std::string wide = "y_m: 0, length_m: 4, width_m: 3, material: stone";
    EXPECT_NEAR(last_z_m(read(kTwoSteps)), rex::kStand_m, kExact_m);
    EXPECT_NEAR(last_z_m(read(kTwoSteps, "  - box: {x_m: 2.5, top_m: 0.1, " + wide + "}\n")),
                rex::kStand_m + 0.1,
                kExact_m)
        << "a kerb is climbed";
    EXPECT_NEAR(
        last_z_m(read(kTwoSteps, "  - box: {x_m: 2.5, bottom_m: 2.1, top_m: 2.4, " + wide + "}\n")),
        rex::kStand_m,
        kExact_m)
        << "a lintel is no ground";
    EXPECT_NEAR(last_z_m(read(kTwoSteps,
                              "  - box: {x_m: 0.9, y_m: 0.5, length_m: 1, width_m: 0.7, bottom_m: "
                              "0.69, top_m: 0.72, material: stone}\n")),
                rex::kStand_m,
                kExact_m)
        << "neither is a table top, although a foot stands below it";
}

TEST(SceneMotionTest, WhatFeetCannotDoIsRefused) {
    const std::string wide = "y_m: 0, length_m: 4, width_m: 3, material: stone";
    EXPECT_NE(refusal(kTwoSteps, "  - box: {x_m: 2.5, top_m: 0.22, " + wide + "}\n")
                  .find("cannot be followed: simulator: step 2 of the rex (code 9, at x 0.40 y "),
              std::string::npos);
    EXPECT_NE(refusal(kTwoSteps, "  - box: {x_m: 2.5, top_m: 0.5, " + wide + "}\n")
                  .find("would go +0.500 m in height, limit is 0.20 m"),
              std::string::npos);
    const std::string post =
        "  - box: {x_m: 0.8, y_m: 0.25, length_m: 0.05, width_m: 0.05, top_m: 0.2, material: "
        "stone}\n";
    EXPECT_NE(refusal(kTwoSteps, post).find("brings a foot into the solid of line 8 after 21"),
              std::string::npos)
        << refusal(kTwoSteps, post);
    // Steps off the end of the floor.
    EXPECT_NE(refusal("script: approach, motion_model: rex, distance_m: 10")
                  .find("would go -1000.000 m in height"),
              std::string::npos);
}

TEST(SceneMotionTest, TheGroundFollowsARampUnderABridge) {
    Scene scene;
    const int stone = scene.add_material({});
    scene.add(make_ramp({1.0, 0.0}, 8.0, 2.0, 0.0, 1.0, 0.0), stone, Label::ramp);
    scene.add(make_box({5.0, 0.0}, {1.0, 2.0}, 2.5, 2.8), stone, Label::overhang);
    const GroundHeight ground_m = ground_of(scene);
    for (double x_m = 1.0; x_m < 8.5; x_m += 0.4)
        EXPECT_NEAR(ground_m(x_m, 0.0), (x_m - 1.0) / 8.0, kExact_m) << x_m;
}

}  // namespace
}  // namespace surefoot::sim
