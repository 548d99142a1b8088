// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace surefoot::sim {
namespace {

constexpr double kExact_m = 1e-9;

/// A file with these solids; the first one is in line 10.
std::string file_with(const std::string& solids, const std::string& parameters = "{}") {
    return "name: test\n"
           "description: for a test\n"
           "parameters: " +
           parameters +
           "\n"
           "materials:\n"
           "  stone: {pattern: concrete, albedo: 0.4}\n"
           "  wood: {pattern: wood}\n"
           "motion:\n"
           "  waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 1, y_m: 0}]\n"
           "solids:\n" +
           solids;
}

Scene scene_with(const std::string& solids, std::uint64_t seed = 1) {
    const std::string text = file_with(solids);
    auto made = read_scene({"test.yaml", text}, "", seed);
    EXPECT_TRUE(made) << made.error().message;
    return made->scene;
}

double height(const Scene& scene, double x_m, double y_m) {
    const auto top = scene.height_at(x_m, y_m);
    return top ? top->z_m : std::nan("");
}

TEST(SceneFileTest, ParametersAreDrawnInOrderAndUsedInExpressions) {
    const std::string text = file_with(
        "  - box: {x_m: far_m, y_m: 0, length_m: 2 * size_m, width_m: size_m, top_m: "
        "size_m / 4, material: look, label: kind}\n",
        "{size_m: {choice: [0.4, 0.8]}, far_m: {uniform: [2, 2 + size_m]}, look: "
        "{choice: [stone, wood]}, kind: kerb, sum_m: far_m + size_m}");
    bool small = false;
    bool large = false;
    bool stone = false;
    bool wood = false;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const ScriptedScene made = read_scene({"test.yaml", text}, "", seed).value();
        const auto value = [&](const std::string& name) {
            for (const SceneParameter& parameter : made.parameters) {
                if (parameter.name == name) return parameter.value;
            }
            return std::string("nothing");
        };
        const double size_m = std::stod(value("size_m"));
        const double far_m = std::stod(value("far_m"));
        EXPECT_GE(far_m, 2.0);
        EXPECT_LE(far_m, 2.0 + size_m);
        EXPECT_EQ(std::stod(value("sum_m")), far_m + size_m);
        (size_m == 0.4 ? small : large) = true;
        (value("look") == "stone" ? stone : wood) = true;
        EXPECT_EQ(made.scene.surfaces().front().material, value("look") == "stone" ? 0 : 1);
        EXPECT_EQ(made.scene.surfaces().front().label, Label::kerb);
        EXPECT_EQ(height(made.scene, far_m + 0.99 * size_m, 0.49 * size_m), size_m / 4.0);
        EXPECT_TRUE(std::isnan(height(made.scene, far_m + 1.01 * size_m, 0.0)));
        EXPECT_EQ(read_scene({"test.yaml", text}, "", seed).value().parameters, made.parameters);
    }
    EXPECT_TRUE(small && large && stone && wood);
}

TEST(SceneFileTest, AFlightUpHasItsFigures) {
    const Scene scene = scene_with(
        "  - flight: {x_m: 2, y_m: 1, heading_deg: 90, steps: 4, rise_m: 0.15, going_m: 0.3, "
        "width_m: 1, landing_m: 0.7, material: stone}\n");
    for (int step = 0; step < 4; ++step) {
        const double begin_m = 1.0 + step * 0.3;
        const double end_m = step < 3 ? begin_m + 0.3 : begin_m + 0.7;
        for (const double y_m : {begin_m + 1e-6, end_m - 1e-6}) {
            EXPECT_NEAR(height(scene, 2.0, y_m), (step + 1) * 0.15, kExact_m) << step;
            EXPECT_NEAR(height(scene, 2.4999, y_m), (step + 1) * 0.15, kExact_m) << step;
            EXPECT_TRUE(std::isnan(height(scene, 2.5001, y_m))) << step;
        }
    }
    EXPECT_TRUE(std::isnan(height(scene, 2.0, 0.999)));
    EXPECT_TRUE(std::isnan(height(scene, 2.0, 2.601)));
}

TEST(SceneFileTest, AFlightDownEndsAtTheFloorBelow) {
    const Scene scene = scene_with(
        "  - floor: {min_x_m: -2, min_y_m: -2, max_x_m: 9, max_y_m: 2, z_m: -0.6, material: "
        "stone}\n"
        "  - flight: {x_m: 1, y_m: 0, direction: down, steps: 3, rise_m: 0.2, going_m: 0.25, "
        "width_m: 1, material: wood}\n");
    EXPECT_NEAR(height(scene, 0.999, 0.0), -0.6, kExact_m);
    EXPECT_NEAR(height(scene, 1.001, 0.0), -0.2, kExact_m);
    EXPECT_NEAR(height(scene, 1.249, 0.0), -0.2, kExact_m);
    EXPECT_NEAR(height(scene, 1.251, 0.0), -0.4, kExact_m);
    EXPECT_NEAR(height(scene, 1.499, 0.0), -0.4, kExact_m);
    EXPECT_NEAR(height(scene, 1.501, 0.0), -0.6, kExact_m);
}

/// Seen from the side, half a step above each tread: boards only, or risers set back by the nosing.
TEST(SceneFileTest, NosingsOverhangAndOpenFlightsHaveNoRisers) {
    const auto side_view = [](const Scene& scene, double x_m, double z_m) {
        const auto solid = scene.solid_at({x_m, 0.0, z_m});
        return solid.has_value();
    };
    const std::string keys =
        "x_m: 2, y_m: 0, steps: 3, rise_m: 0.18, going_m: 0.3, width_m: 1, nosing_m: 0.02, "
        "tread_thickness_m: 0.03, material: wood";
    const Scene closed = scene_with("  - flight: {" + keys + "}\n");
    const Scene open = scene_with("  - flight: {open: true, " + keys + "}\n");
    for (int step = 1; step <= 3; ++step) {
        const double nose_m = 2.0 + (step - 1) * 0.3;
        const double top_m = step * 0.18;
        for (const Scene* scene : {&closed, &open}) {
            EXPECT_NEAR(height(*scene, nose_m + 1e-6, 0.0), top_m, kExact_m);
            EXPECT_TRUE(side_view(*scene, nose_m + 0.01, top_m - 0.02));
            EXPECT_FALSE(side_view(*scene, nose_m + 0.01, top_m - 0.04));
        }
        EXPECT_TRUE(side_view(closed, nose_m + 0.021, top_m - 0.04));
        EXPECT_FALSE(side_view(open, nose_m + 0.021, top_m - 0.04));
    }
}

TEST(SceneFileTest, UnevenRisesKeepTheirLimitAndTheirSum) {
    const std::string solids =
        "  - flight: {x_m: 1, y_m: 0, steps: 8, rise_m: 0.17, going_m: 0.3, width_m: 1, "
        "rise_variation_m: 0.005, material: wood}\n";
    double largest_m = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Scene scene = scene_with(solids, seed);
        double below_m = 0.0;
        for (int step = 0; step < 8; ++step) {
            const double top_m = height(scene, 1.1 + 0.3 * step, 0.0);
            largest_m = std::max(largest_m, std::abs(top_m - below_m - 0.17));
            below_m = top_m;
        }
        EXPECT_NEAR(below_m, 8 * 0.17, kExact_m);
    }
    EXPECT_LE(largest_m, 0.005 + kExact_m);
    EXPECT_GT(largest_m, 0.003);
}

TEST(SceneFileTest, ASpiralTurnsAndClimbs) {
    for (const int side : {-1, 1}) {
        const Scene scene = scene_with(
            "  - spiral: {x_m: 3, y_m: 1, start_deg: -90, turn_deg: " + std::to_string(25 * side) +
            ", steps: 8, rise_m: 0.18, inner_radius_m: 0.1, outer_radius_m: 1.0, material: "
            "wood}\n");
        for (int step = 0; step < 8; ++step) {
            for (const double share : {0.01, 0.5, 0.99}) {
                const double angle_rad =
                    (-90.0 + side * 25.0 * (step + share)) * std::numbers::pi / 180.0;
                const auto at = [&](double radius_m) {
                    return height(scene,
                                  3.0 + radius_m * std::cos(angle_rad),
                                  1.0 + radius_m * std::sin(angle_rad));
                };
                EXPECT_NEAR(at(0.11), (step + 1) * 0.18, kExact_m) << step;
                // Six chords of 25 deg / 6 leave less than 0.7 mm of the circle.
                EXPECT_NEAR(at(0.9993), (step + 1) * 0.18, kExact_m) << step;
                EXPECT_TRUE(std::isnan(at(1.0001))) << step;
            }
        }
    }
}

TEST(SceneFileTest, ADoorIsAsWideAsItSays) {
    const Scene scene = scene_with(
        "  - floor: {min_x_m: -2, min_y_m: -3, max_x_m: 9, max_y_m: 3, material: stone}\n"
        "  - door: {x_m: 2, y_m: 0.5, width_m: 0.76, thickness_m: 0.1, sill_m: 0.013, "
        "wall_left_m: 1, wall_right_m: 0, material: wood}\n");
    const auto label_at = [&](double x_m, double y_m) {
        return scene.surfaces()[static_cast<std::size_t>(scene.height_at(x_m, y_m)->surface)].label;
    };
    EXPECT_EQ(label_at(2.0, 0.5 + 0.379), Label::sill);
    EXPECT_EQ(label_at(2.0, 0.5 - 0.379), Label::sill);
    EXPECT_NEAR(height(scene, 2.049, 0.5), 0.013, kExact_m);
    EXPECT_NEAR(height(scene, 2.051, 0.5), 0.0, kExact_m);
    EXPECT_EQ(label_at(2.0, 0.5 + 0.381), Label::door);
    EXPECT_EQ(label_at(2.0, 0.5 - 0.381), Label::door);
    EXPECT_EQ(label_at(2.0, 0.5 + 0.44), Label::wall);
    EXPECT_EQ(label_at(2.0, 0.5 - 0.44), Label::floor);
    EXPECT_EQ(label_at(1.94, 0.5), Label::floor);
}

TEST(SceneFileTest, GroupsTurnAndRepeatsCount) {
    const Scene scene = scene_with(
        "  - group:\n"
        "      {x_m: 2, y_m: 1, z_m: 0.5, heading_deg: 90, solids: [\n"
        "        {repeat: {count: 3, name: k, solids: [\n"
        "          {box: {x_m: k, y_m: 0, length_m: 0.2, width_m: 0.1, top_m: 0.1 + k, material: "
        "wood}}]}}]}\n");
    EXPECT_EQ(scene.primitives(), 3);
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(height(scene, 2.04, 1.0 + k + 0.09), 0.6 + k, kExact_m);
        EXPECT_TRUE(std::isnan(height(scene, 2.06, 1.0 + k)));
        EXPECT_FALSE(scene.solid_at({2.0, 1.0 + k, 0.49}));
    }
}

TEST(SceneFileTest, ARepeatDrawsForEachCopy) {
    const std::string solids =
        "  - repeat: {count: 20, name: k, parameters: {high_m: {uniform: [0.1, 0.2]}, look: "
        "{choice: [stone, wood]}}, solids: [{box: {x_m: 2 + k, y_m: 0, length_m: 0.5, width_m: 1, "
        "top_m: high_m, material: look}}]}\n";
    const Scene scene = scene_with(solids);
    std::set<double> heights_m;
    std::set<int> looks;
    for (int k = 0; k < 20; ++k) {
        const double high_m = height(scene, 2.0 + k, 0.0);
        EXPECT_GE(high_m, 0.1);
        EXPECT_LE(high_m, 0.2);
        heights_m.insert(high_m);
        looks.insert(scene.surfaces()[static_cast<std::size_t>(scene.first_surface(k))].material);
        EXPECT_EQ(high_m, height(scene_with(solids), 2.0 + k, 0.0)) << "the seed decides";
    }
    EXPECT_EQ(heights_m.size(), 20U);
    EXPECT_EQ(looks.size(), 2U);
    EXPECT_NE(height(scene_with(solids, 2), 2.0, 0.0), height(scene, 2.0, 0.0));
    const auto after =
        read_scene({"test.yaml",
                    file_with(solids + "  - box: {x_m: 9, y_m: 9, length_m: 1, width_m: 1, "
                                       "top_m: high_m, material: stone}\n")},
                   "",
                   1);
    ASSERT_FALSE(after);
    EXPECT_NE(after.error().message.find("no number is named 'high_m'"), std::string::npos);
}

TEST(SceneFileTest, SolidsAreCountedOnceEach) {
    const auto made = read_scene(
        {"test.yaml",
         file_with("  - table: {x_m: 3, y_m: 1, length_m: 1, width_m: 1, material: wood}\n"
                   "  - repeat: {count: 3, name: k, solids: [{cylinder: {x_m: 4 + k, y_m: 2, "
                   "radius_m: 0.1, top_m: 1, material: stone}}]}\n")},
        "",
        1);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made->solids, 4);
    EXPECT_GT(made->scene.primitives(), 4);
}

TEST(SceneFileTest, AScannerStandsOverTheGround) {
    const std::string solids =
        "  - floor: {min_x_m: -5, min_y_m: -5, max_x_m: 5, max_y_m: 5, material: stone}\n"
        "  - box: {x_m: 3, y_m: 3, length_m: 1, width_m: 1, top_m: 0.5, material: stone}\n";
    const auto made =
        read_scene({"test.yaml",
                    file_with(solids) +
                        "scan: {stations: [{x_m: -2, y_m: 1}, {x_m: 3, y_m: 3, above_m: 1}]}\n"},
                   "",
                   1);
    ASSERT_TRUE(made) << made.error().message;
    ASSERT_EQ(made->stations_m.size(), 2U);
    EXPECT_EQ(made->stations_m[0], Eigen::Vector3d(-2.0, 1.0, 1.6));
    EXPECT_EQ(made->stations_m[1], Eigen::Vector3d(3.0, 3.0, 1.5));
    const auto error_of = [&](const std::string& scan) {
        const auto bad = read_scene({"test.yaml", file_with(solids) + scan}, "", 1);
        return bad ? std::string("accepted") : bad.error().message;
    };
    EXPECT_NE(error_of("scan: {stations: [{x_m: 7, y_m: 0}]}\n").find("there is no ground"),
              std::string::npos);
    EXPECT_NE(
        error_of("scan: {stations: []}\n").find("'stations' has 0 entries; 1 to 100 are allowed"),
        std::string::npos);
    EXPECT_NE(error_of("scan: {from: 3}\n").find("unknown key 'from'"), std::string::npos);
}

TEST(SceneFileTest, AHandCarriesTheCameraUpAStairAtItsHeight) {
    const auto text_with = [](const std::string& motion) {
        std::string text = file_with(
            "  - floor: {min_x_m: -5, min_y_m: -5, max_x_m: 9, max_y_m: 5, material: stone}\n"
            "  - flight: {x_m: 2, y_m: 0, steps: 5, rise_m: 0.2, going_m: 0.25, width_m: 2, "
            "landing_m: 3, material: stone}\n");
        const std::string old = "  waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 1, y_m: 0}]\n";
        return text.replace(text.find(old), old.size(), motion);
    };
    const std::string way =
        "  waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 1.75, y_m: 0}, {x_m: 3, y_m: 0, "
        "ground_z_m: 1}]\n";
    const auto made = read_scene(
        {"test.yaml", text_with("  motion_model: hand\n  height_m: 1.8\n" + way)}, "", 1);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_NEAR(made->motion->at(0.0).T_world_body.translation_m.z(), 1.8, 1e-9);
    EXPECT_NEAR(made->motion->at(1e3).T_world_body.translation_m.z(), 2.8, 1e-9);
    const auto error_of = [&](const std::string& motion) {
        const auto bad = read_scene({"test.yaml", text_with(motion)}, "", 1);
        return bad ? std::string("accepted") : bad.error().message;
    };
    EXPECT_NE(error_of(way).find("motion_model trolley climbs 1:2 at most"), std::string::npos)
        << error_of(way);
    EXPECT_NE(
        error_of("  height_m: 1.8\n" + way).find("height_m is allowed for motion_model hand only"),
        std::string::npos);
    EXPECT_NE(error_of("  motion_model: hand\n  height_m: 0.1\n" + way)
                  .find("height_m is 0.1; for motion_model hand"),
              std::string::npos);
}

TEST(SceneFileTest, AVariantMayGoItsOwnWay) {
    std::string text = file_with(
        "  - box: {x_m: 5, y_m: 0, length_m: 1, width_m: 1, top_m: far_m, "
        "material: stone}\n");
    text =
        "variants:\n"
        "  near: {description: as the file says, far_m: 1}\n"
        "  far: {description: its own way, far_m: 1, motion: {waypoints: [{x_m: 0, y_m: 0}, {x_m: "
        "2 * far_m, y_m: 0}]}}\n" +
        text.substr(text.find("parameters"));
    const auto end_x_m = [&](const char* name) {
        const auto made = read_scene({"test.yaml", text}, name, 1);
        EXPECT_TRUE(made) << made.error().message;
        return made->motion->at(1e3).T_world_body.translation_m.x();
    };
    EXPECT_NEAR(end_x_m("near"), 1.0, 0.02);
    EXPECT_NEAR(end_x_m("far"), 2.0, 0.02);
}

struct BadFile {
    std::string text;
    std::string message;
};

/// Every message names file, line, value and problem.
TEST(SceneFileTest, MistakesAreNamedWithFileLineValueAndLimit) {
    const std::string box = "x_m: 3, y_m: 0, length_m: 1, width_m: 1, top_m: 1, material: stone";
    const std::vector<BadFile> files{
        {"name: a\n  b: [", "test.yaml:2: not valid YAML"},
        {"[1, 2]", "test.yaml:1: key 'name' is missing"},
        {"name: a\nname: b\n", "test.yaml:2: key 'name' appears twice"},
        {"name: a b\ndescription: c\n", "test.yaml:1: 'a b' is not a valid name for a scene"},
        {"name: a\ndescription: b\n", "test.yaml:1: key 'materials' is missing"},
        {"name: a\ndescription: b\nsolid: []\n", "test.yaml:3: unknown key 'solid'"},
        {"variants: {}\n", "test.yaml:1: 'variants' names no scene"},
        {"variants: {a: {rise_m: 1}}\n", "test.yaml:1: key 'description' is missing"},
        {file_with("  - box: {" + box + ", colour: red}\n"), "test.yaml:10: unknown key 'colour'"},
        {file_with("  - box: {x_m: 3}\n"), "test.yaml:10: key 'material' is missing"},
        {file_with("  - box: {x_m: 3, material: stone}\n"), "test.yaml:10: key 'y_m' is missing"},
        {file_with("  - box: {x_m: 3, y_m: 0, length_m: 1, width_m: -1, top_m: 1, material: "
                   "stone}\n"),
         "test.yaml:10: 'width_m' is -1; it must be 0.001 to 100"},
        {file_with("  - box: {x_m: 3, y_m: 0, length_m: 0, width_m: 1, top_m: 1, material: "
                   "stone}\n"),
         "test.yaml:10: 'length_m' is 0; it must be 0.001 to 100"},
        {file_with("  - box: {" + box + ", bottom_m: 1.5}\n"),
         "test.yaml:10: 'box' top_m 1 must be above bottom_m 1.5"},
        {file_with("  - box:\n      {material: stone, x_m: [1]}\n"),
         "test.yaml:11: 'x_m' needs a number, not a list"},
        {file_with("  - box: {material: stone, x_m: far}\n"),
         "test.yaml:10: 'x_m' needs a number: "},
        {file_with("  - box: {material: stone, x_m: far}\n"), "no number is named 'far'"},
        {file_with("  - box: {material: stone, x_m: 1/0}\n"), "the value is not finite"},
        {file_with("  - box: {material: stone, x_m: .nan}\n"),
         "test.yaml:10: 'x_m' needs a number"},
        {file_with("  - box: {material: gold}\n"),
         "'material' is 'gold'; it must be one of stone, wood"},
        {file_with("  - box: {material: stone, label: lava}\n"),
         "'label' is 'lava'; it must be one of"},
        {file_with("  - cone: {x_m: 1}\n"),
         "test.yaml:10: 'cone' is not a solid; known solids: box"},
        {file_with("  - box\n"), "test.yaml:10: a solid is one group"},
        {file_with("  - floor: {min_x_m: 1, min_y_m: 0, max_x_m: 0, max_y_m: 1, material: "
                   "stone}\n"),
         "test.yaml:10: 'floor' max_x_m 0 must be at least 1 mm above min_x_m 1"},
        {file_with("  - group: {heading_deg: 5, solids: [{floor: {min_x_m: 0, min_y_m: 0, max_x_m: "
                   "1, max_y_m: 1, material: stone}}]}\n"),
         "'floor' cannot stand in a turned group"},
        {file_with("  - flight: {x_m: 2, y_m: 0, steps: 2.5, rise_m: 0.2, going_m: 0.3, width_m: "
                   "1, material: stone}\n"),
         "test.yaml:10: 'steps' needs a whole number, not 2.5"},
        {file_with("  - flight: {x_m: 2, y_m: 0, steps: 3, rise_m: 0.2, going_m: 0.3, width_m: 1, "
                   "rise_variation_m: 0.006, material: stone}\n"),
         "'rise_variation_m' is 0.006; it must be 0 to 0.005"},
        {file_with("  - flight: {x_m: 2, y_m: 0, rise_m: 0.2, going_m: 0.3, width_m: 1, material: "
                   "stone}\n"),
         "'flight' key 'steps' is missing"},
        {file_with("  - spiral: {x_m: 2, y_m: 0, steps: 20, turn_deg: 20, rise_m: 0.2, "
                   "inner_radius_m: 0.1, outer_radius_m: 1, material: stone}\n"),
         "20 steps of 20 deg go round more than once"},
        {file_with("  - door: {x_m: 2, y_m: 0, width_m: 0.9, opening_height_m: 3, material: "
                   "stone}\n"),
         "wall_height_m 2.4 leaves no lintel above opening_height_m 3"},
        {file_with("  - table: {x_m: 2, y_m: 0, length_m: 1, width_m: 0.1, material: stone}\n"),
         "'table' leg_inset_m 0.06 must be below half"},
        {file_with("  - repeat: {count: 3000, name: k, solids: []}\n"),
         "'count' is 3000; it must be 0 to 2000"},
        {file_with(
             "  - repeat: {count: 50, name: k, solids: [{repeat: {count: 50, name: j, solids: "
             "[{box: {" +
             box + "}}]}}]}\n"),
         "test.yaml:10: 'box' brings the scene to 2001 primitives; a scene may have at most 2000"},
        {file_with("  - repeat: {count: 2, name: k, solids: [{repeat: {count: 2, name: k, solids: "
                   "[]}}]}\n"),
         "parameter 'k' is defined twice"},
        {file_with("  - box: {x_m: 0, y_m: 0, length_m: 1, width_m: 1, top_m: 2, material: "
                   "stone}\n"),
         "test.yaml:7: 'motion' brings the camera or base_link into the solid of line 10 after "
         "0.00 s"},
        {file_with("  - box: {x_m: 1, y_m: 0.25, length_m: 0.1, width_m: 0.1, top_m: 2, material: "
                   "stone}\n"),
         "into the solid of line 10 after"},
        {file_with("", "{a: {uniform: [2, 1]}}"), "test.yaml:3: 'a' has its low end 2 above"},
        {file_with("", "{a: {uniform: [2]}}"), "test.yaml:3: 'a' needs uniform: [low, high]"},
        {file_with("", "{a: {choice: []}}"), "test.yaml:3: 'a' needs choice: [a, b, ...]"},
        {file_with("", "{a: {normal: [0, 1]}}"), "test.yaml:3: unknown key 'normal'"},
        {file_with("", "{a: 1, b: a + c}"), "no number is named 'c'"},
        {file_with("", "{a-b: 1}"), "test.yaml:3: 'a-b' is not a valid name for a parameter"},
    };
    for (const BadFile& file : files) {
        const auto made = read_scene({"test.yaml", file.text}, "", 1);
        ASSERT_FALSE(made) << "accepted:\n" << file.text;
        EXPECT_EQ(made.error().code, ErrorCode::input);
        EXPECT_EQ(made.error().message.find("test.yaml:"), 0U) << made.error().message;
        EXPECT_NE(made.error().message.find(file.message), std::string::npos)
            << made.error().message << "\nshould contain: " << file.message;
    }
}

/// Regression: the search for repeated keys is quadratic; 90 000 keys in less than 1 MB took 20 s.
TEST(SceneFileTest, AGroupHasALimitedNumberOfKeys) {
    const auto with_keys = [](int count) {
        std::string text = "name: test\n";
        for (int i = 1; i < count; ++i) text += "k" + std::to_string(i) + ": 1\n";
        const auto made = read_scene({"test.yaml", text}, "", 1);
        return made ? std::string("accepted") : made.error().message;
    };
    EXPECT_EQ(with_keys(10'001),
              "test.yaml:10001: more than 10000 keys in a group; use fewer keys");
    EXPECT_EQ(with_keys(90'000),
              "test.yaml:10001: more than 10000 keys in a group; use fewer keys");
    EXPECT_EQ(with_keys(10'000).find("more than"), std::string::npos);
}

TEST(SceneFileTest, MaterialsLightAndMotionAreChecked) {
    const std::string solids =
        "  - box: {x_m: 3, y_m: 0, length_m: 1, width_m: 1, top_m: 1, "
        "material: stone}\n";
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = file_with(solids);
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    const std::vector<BadFile> files{
        {replaced("pattern: concrete", "pattern: marble"),
         "test.yaml:5: 'pattern' is 'marble'; it must be one of carpet, "},
        {replaced("albedo: 0.4", "albedo: 1.4"), "test.yaml:5: 'albedo' is 1.4; it must be 0 to 1"},
        {replaced("pattern: wood", "shine: 1"), "test.yaml:6: unknown key 'shine'"},
        {replaced("motion:", "lighting: {lamp: -1}\nmotion:"), "test.yaml:7: 'lamp' is -1"},
        {replaced("motion:", "lighting: {shadows: 3}\nmotion:"),
         "test.yaml:7: 'shadows' needs true or false, not '3'"},
        {replaced("waypoints:", "motion_model: horse\n  waypoints:"),
         "test.yaml:8: 'motion_model' is 'horse'; it must be one of trolley, rex, hand"},
        {replaced("[{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 1, y_m: 0}]", "[]"),
         "test.yaml:8: 'waypoints' has 0 entries; 1 to 1000 are allowed"},
        {replaced("pause_s: 1", "pause_s: -1"), "test.yaml:8: 'pause_s' is -1"},
    };
    for (const BadFile& file : files) {
        const auto made = read_scene({"test.yaml", file.text}, "", 1);
        ASSERT_FALSE(made) << "accepted:\n" << file.text;
        EXPECT_NE(made.error().message.find(file.message), std::string::npos)
            << made.error().message << "\nshould contain: " << file.message;
    }
}

TEST(SceneFileTest, VariantsShareAFileAndFixItsFigures) {
    std::string text = file_with(
        "  - box: {x_m: 3, y_m: 0, length_m: 1, width_m: 1, top_m: high_m, "
        "material: stone}\n");
    text =
        "variants:\n"
        "  low: {description: a low one, high_m: 0.1}\n"
        "  high: {description: a high one, high_m: 0.3}\n" +
        text.substr(text.find("parameters"));
    const auto infos = read_scene_infos({"test.yaml", text});
    ASSERT_TRUE(infos) << infos.error().message;
    ASSERT_EQ(infos->size(), 2U);
    EXPECT_EQ((*infos)[1].name, "high");
    EXPECT_EQ((*infos)[1].description, "a high one");
    EXPECT_EQ(height(read_scene({"test.yaml", text}, "low", 1)->scene, 3.0, 0.0), 0.1);
    EXPECT_EQ(height(read_scene({"test.yaml", text}, "high", 1)->scene, 3.0, 0.0), 0.3);
    const auto drawn = [&](const std::string& name, std::uint64_t seed) {
        return read_scene({"test.yaml", text}, name, seed)->motion->at(1e3).T_world_body;
    };
    EXPECT_EQ(drawn("low", 5).translation_m, drawn("low", 5).translation_m);
    EXPECT_NE(drawn("low", 5).translation_m, drawn("high", 5).translation_m)
        << "the name counts with the seed";
    EXPECT_EQ(read_scene({"test.yaml", text}, "", 1).error().message,
              "test.yaml:1: the file holds 2 scenes; add '#NAME' to the file name, with one of "
              "these names: low, high");
    EXPECT_EQ(read_scene({"test.yaml", text}, "flat", 1).error().message,
              "test.yaml:1: no scene is named 'flat'; there are: low, high");
}

}  // namespace
}  // namespace surefoot::sim
