// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scenes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

#include "surefoot/core/time.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/safety_oracle/safety_testing.hpp"
#include "surefoot/sim/scenes/embedded_scenes.hpp"
#include "surefoot/sim/scenes/truth.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Seeds with which the tests check the description of a scene.
constexpr std::uint64_t kSeeds[] = {1, 2, 3, 4, 5, 6};

/// Truth of a whole run at 5 Hz.
SceneTruth whole_run(const std::string& name, std::uint64_t seed) {
    ScriptedScene script = make_scene(name, seed).value();
    SceneTruth truth;
    truth.rig = rig_preset("zed_vga").value();
    for (double t_s = 0.0; t_s <= script.motion->duration_s(); t_s += 0.2) {
        truth.trajectory.push_back({ns_from_seconds(t_s), script.motion->at(t_s).T_world_body});
    }
    truth.scene = std::move(script.scene);
    return truth;
}

/// Share of the 25 mm cells of a rectangle that the run has observed within 2.5 m.
double seen_share(const SceneTruth& truth, const Rect& area) {
    Lattice lattice;
    lattice.origin_m = area.min_m;
    lattice.nx = static_cast<int>(std::lround((area.max_m.x() - area.min_m.x()) / 0.025));
    lattice.ny = static_cast<int>(std::lround((area.max_m.y() - area.min_m.y()) / 0.025));
    Serial serial;
    const Image<std::uint8_t> mask = visibility_mask(truth, lattice, {}, serial);
    double seen = 0.0;
    for (std::size_t i = 0; i < mask.size(); ++i) seen += mask.data()[i];
    return seen / static_cast<double>(mask.size());
}

TEST(ScenesTest, EveryFileInTheProgramIsWellFormedAndNamesDiffer) {
    std::set<std::string> names;
    for (const SceneFile& file : embedded_scenes()) {
        const auto infos = read_scene_infos(file);
        ASSERT_TRUE(infos) << infos.error().message;
        for (const SceneInfo& info : *infos) {
            EXPECT_TRUE(names.insert(info.name).second) << info.name << " is there twice";
        }
    }
    EXPECT_GE(names.size(), 100U);
}

TEST(ScenesTest, EveryListedSceneCanBeMadeAndIsClosed) {
    for (const SceneInfo& info : list_scenes()) {
        EXPECT_FALSE(info.description.empty()) << info.name;
        EXPECT_EQ(info.description.find('\n'), std::string::npos) << info.name;
        const auto made = make_scene(info.name, 3);
        ASSERT_TRUE(made) << made.error().message;
        const ScriptedScene& script = *made;
        EXPECT_EQ(script.info.name, info.name);
        EXPECT_NEAR(script.scene.height_at(0.0, 0.0)->z_m, 0.0, 1e-12) << info.name;
        // From every place of the path the view ends somewhere: on the ground or at a wall.
        for (double t_s = 0.0; t_s < script.motion->duration_s(); t_s += 1.7) {
            const Pose T = script.motion->at(t_s).T_world_body;
            for (double azimuth_rad = 0.0; azimuth_rad < 6.3; azimuth_rad += 0.1) {
                const Vector3d level(std::cos(azimuth_rad), std::sin(azimuth_rad), -0.02);
                EXPECT_TRUE(script.scene.intersect(T.translation_m, level.normalized()))
                    << info.name << " at " << t_s << " s, azimuth " << azimuth_rad;
            }
        }
    }
}

TEST(ScenesTest, UnknownNamesSayWhatIsLikelyAndWhereTheListIs) {
    const auto scene = make_scene("demo_stair", 1);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, ErrorCode::usage);
    EXPECT_EQ(
        scene.error().message,
        "simulator: no scene is named 'demo_stair'; did you mean 'demo_stairs'? 'surefoot sim "
        "--list' shows all " +
            std::to_string(list_scenes().size()) + " scenes");
    EXPECT_EQ(make_scene("qqqqqqqqqqq", 1).error().message.find("did you mean"), std::string::npos);
    const auto rig = rig_preset("zed_vag");
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().code, ErrorCode::usage);
    EXPECT_NE(rig.error().message.find("did you mean 'zed_vga'"), std::string::npos);
    EXPECT_NE(rig.error().message.find("duo_mlx"), std::string::npos);
}

TEST(ScenesTest, TheSeedMovesThePathByCentimetresFromWhatTheFileSays) {
    std::set<double> off_m;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const ScriptedScene demo = make_scene("demo_stairs", seed).value();
        EXPECT_EQ(demo.motion->at(0.0).T_world_body.translation_m,
                  Vector3d(0.0, 0.0, kBodyHeight_m));
        const Waypoint& last = demo.script.waypoints.back();
        EXPECT_EQ(last.x_m, drawn_number(demo, "drive_m"));
        const Vector3d end_m = demo.motion->at(1e3).T_world_body.translation_m;
        const Vector3d moved_m = end_m - Vector3d(last.x_m, last.y_m, kBodyHeight_m);
        EXPECT_GT(moved_m.norm(), 0.0);
        EXPECT_LT(moved_m.norm(), 0.015);
        off_m.insert(moved_m.x());
    }
    EXPECT_EQ(off_m.size(), 5U);
}

TEST(ScenesTest, PresetCameraIsOneMetreHighAnd32DegreesDown) {
    for (const std::string& name : rig_presets()) {
        const camera::StereoRig rig = rig_preset(name).value();
        EXPECT_FALSE(rig.problem()) << *rig.problem();
        const Vector3d forward = rig.T_body_left->rotation * Vector3d::UnitZ();
        EXPECT_NEAR(std::asin(-forward.z()) * 180.0 / std::acos(-1.0), 32.0, 1e-9);
        EXPECT_NEAR(forward.y(), 0.0, 1e-12);
        EXPECT_GT(forward.x(), 0.0);
        EXPECT_NEAR(kBodyHeight_m + rig.T_body_left->translation_m.z(), 1.0, 1e-12);
        // The right camera is to the right: at smaller y.
        const Pose T_body_right = *rig.T_body_left * rig.T_left_right;
        const double baseline_m = rig.T_left_right.translation_m.x();
        EXPECT_NEAR(T_body_right.translation_m.y(), 0.25 - baseline_m, 1e-12);
    }
}

/// The gate places a foot 0.27 to 0.64 m ahead of base_link, within about 0.3 m of its axis.
TEST(ScenesTest, AtTheEndOfTheDemoTheNextStepLandsOnFloorThatWasSeen) {
    for (const std::uint64_t seed : kSeeds) {
        const SceneTruth truth = whole_run("demo_stairs", seed);
        const double x_m = truth.trajectory.back().T_world_body.translation_m.x();
        EXPECT_EQ(seen_share(truth, {{x_m - 0.2, -0.35}, {x_m + 0.75, 0.35}}), 1.0) << seed;
        // The ground beside the start was never observed; a step from there needs an operator
        // attestation.
        EXPECT_EQ(seen_share(truth, {{-0.3, -0.3}, {0.3, 0.3}}), 0.0) << seed;
    }
}

TEST(ScenesTest, TheDemoShowsStairTableRampAndPit) {
    for (const std::uint64_t seed : kSeeds) {
        const ScriptedScene demo = make_scene("demo_stairs", seed).value();
        const SceneTruth truth = whole_run("demo_stairs", seed);
        const double riser_m = drawn_number(demo, "stair_x_m");
        const double third_tread_m = riser_m + 2.0 * demo_stairs::kGoing_m;
        EXPECT_EQ(seen_share(truth, {{riser_m, -0.5}, {third_tread_m, 0.5}}), 1.0) << seed;
        const Vector2d table_m(drawn_number(demo, "table_x_m"), drawn_number(demo, "table_y_m"));
        const Vector2d half_m(0.5, 0.35);
        EXPECT_GT(seen_share(truth, {table_m - half_m, table_m + half_m}), 0.9) << seed;
        const Vector2d ramp_m(drawn_number(demo, "ramp_x_m"), drawn_number(demo, "ramp_y_m"));
        EXPECT_GT(seen_share(truth, {ramp_m - Vector2d(0.0, 0.5), ramp_m + Vector2d(0.6, 0.5)}),
                  0.7)
            << seed;
        const Vector2d pit_m(drawn_number(demo, "pit_x_m"), drawn_number(demo, "pit_y_m"));
        EXPECT_GT(seen_share(truth, {pit_m - Vector2d(0.0, 0.9), pit_m + Vector2d(1.3, 0.0)}), 0.3)
            << seed;
        // A body in front of the table stands on seen floor and reaches it with one step ahead.
        const double side_m = table_m.x() - half_m.x();
        EXPECT_EQ(seen_share(truth, {{side_m - 0.5, 0.9}, {side_m, 1.4}}), 1.0) << seed;
    }
}

/// Queries of tools/demo and end_to_end.chain to the gate at fixed places of the demonstration.
TEST(ScenesTest, TheDangersOfTheDemoAreWhereTheyAreAskedForInEveryVariant) {
    const Machine machine = testing::rex();
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const Scene scene = make_scene("demo_stairs", seed).value().scene;
        const auto dangers = [&](double x_m, double y_m, double yaw_rad) {
            const auto answer =
                judge(scene, machine, testing::standing(x_m, y_m, yaw_rad), testing::kForward);
            EXPECT_TRUE(answer.clear_cut) << seed;
            EXPECT_FALSE(answer.has(Danger::no_stance)) << seed;
            return answer;
        };
        const SafetyAnswer table = dangers(1.4, 1.0, 0.0);
        EXPECT_TRUE(table.has(Danger::obstacle_in_way) || table.has(Danger::body_hits)) << seed;
        EXPECT_TRUE(dangers(3.2, 0.0, 0.0).has(Danger::step_up)) << seed;
        EXPECT_TRUE(dangers(1.9, -0.5, -0.5 * std::numbers::pi).has(Danger::drop_off)) << seed;
    }
}

TEST(ScenesTest, BeforeThePlatformEdgeTheNextStepIsHalfOverIt) {
    for (const std::uint64_t seed : kSeeds) {
        const ScriptedScene platform = make_scene("platform_edge", seed).value();
        const double edge_m = drawn_number(platform, "edge_x_m");
        const double drop_m = drawn_number(platform, "drop_m");
        EXPECT_GE(drop_m, 0.10);
        EXPECT_LE(drop_m, 0.40);
        const SceneTruth truth = whole_run("platform_edge", seed);
        const double x_m = truth.trajectory.back().T_world_body.translation_m.x();
        const double middle_of_foot_m = x_m + 0.5 * (0.27 + 0.64);
        EXPECT_NEAR(middle_of_foot_m, edge_m, 0.03) << seed;
        EXPECT_EQ(truth.scene.height_at(edge_m + 0.01, 0.0)->z_m, -drop_m) << seed;
        EXPECT_EQ(truth.scene.height_at(edge_m - 0.01, 0.0)->z_m, 0.0) << seed;
        EXPECT_EQ(seen_share(truth, {{x_m - 0.2, -0.3}, {edge_m, 0.3}}), 1.0) << seed;
    }
}

TEST(ScenesTest, TheTableIsAsHighAsTablesAreAndStandsAcrossTheEndOfTheWay) {
    for (const std::uint64_t seed : kSeeds) {
        const ScriptedScene table = make_scene("table", seed).value();
        const double end_m = table.motion->at(1e3).T_world_body.translation_m.x();
        const double side_m = drawn_number(table, "distance_m");
        EXPECT_NEAR(side_m - end_m, 0.45, 0.015) << seed;
        const double top_m = table.scene.height_at(side_m + 0.2, 0.0)->z_m;
        EXPECT_GE(top_m, 0.70) << seed;
        EXPECT_LE(top_m, 0.76) << seed;
        EXPECT_EQ(top_m, drawn_number(table, "top_m")) << seed;
    }
}

/// Feet and body of the machine on the ground: 0.65 m long, 0.66 m wide.
constexpr double kHalfLength_m = 0.325;
constexpr double kHalfWidth_m = 0.33;

/// Height of obstacles below a head at 2.05 m; a higher beam leaves the path free.
double ground_m(const Scene& scene, double x_m, double y_m) {
    constexpr double kHead_m = 2.05;
    constexpr double kNothing_m = 1e3;
    for (const SurfaceHeight& surface : scene.surfaces_at(x_m, y_m)) {
        if (surface.z_m < kHead_m) return surface.z_m;
    }
    return kNothing_m;
}

/// Largest height difference between the ground under the machine and z = 0, along the whole path.
double worst_ground_m(const ScriptedScene& script) {
    constexpr int kHalfGrid = 2;
    double worst_m = 0.0;
    for (double t_s = 0.0; t_s < script.motion->duration_s() + 0.5; t_s += 0.5) {
        const Pose T = script.motion->at(t_s).T_world_body;
        for (int ix = -kHalfGrid; ix <= kHalfGrid; ++ix) {
            for (int iy = -kHalfGrid; iy <= kHalfGrid; ++iy) {
                const Vector3d p =
                    T *
                    Vector3d(kHalfLength_m * ix / kHalfGrid, kHalfWidth_m * iy / kHalfGrid, 0.0);
                worst_m = std::max(worst_m, std::abs(ground_m(script.scene, p.x(), p.y())));
            }
        }
    }
    return worst_m;
}

TEST(ScenesTest, EverySeedLeavesTheWayFreeAndDrawsItsOwnParameters) {
    // Where the ground of the way is not flat: 1:50 across half the width, a rug of 8 mm,
    // joints of 1 mm.
    const std::map<std::string, double> uneven_m{{"cross_fall", 0.0075},
                                                 {"room", 0.008},
                                                 {"thesis_h_hall", 0.001},
                                                 {"thesis_h_hall_door", 0.001},
                                                 {"thesis_h_hall_pillar", 0.001},
                                                 {"thesis_h_hall_table", 0.001}};
    // Walks into danger or uphill: walking_scenes_test.cpp checks which of their steps are safe.
    const std::set<std::string> not_free{"thesis_k_production_stairs_climbed",
                                         "walk_back_into_table",
                                         "walk_descend_backwards",
                                         "walk_pivot_reverse_edge",
                                         "walk_ramp_1_12",
                                         "walk_ramp_1_8",
                                         "walk_sidestep_door_760"};
    for (const SceneInfo& info : list_scenes()) {
        const auto uneven = uneven_m.find(info.name);
        const double limit_m = uneven != uneven_m.end() ? uneven->second : 1e-9;
        std::set<std::string> drawn;
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            const auto script = make_scene(info.name, seed);
            ASSERT_TRUE(script) << info.name << " seed " << seed << ": " << script.error().message;
            if (!not_free.contains(info.name)) {
                EXPECT_LE(worst_ground_m(*script), limit_m) << info.name << " seed " << seed;
            }
            std::string all;
            for (const auto& parameter : script->parameters) all += parameter.value + " ";
            drawn.insert(all);
        }
        EXPECT_EQ(drawn.size(), 20U) << info.name;
    }
}

TEST(ScenesTest, OneSeedIsAnotherPlaceInEveryScene) {
    std::map<std::string, std::string> scene_of_azimuth;
    for (const SceneInfo& info : list_scenes()) {
        const ScriptedScene script = make_scene(info.name, 7).value();
        for (const SceneParameter& drawn : script.parameters) {
            if (drawn.name != "lamp_azimuth_deg") continue;
            const auto [other, is_new] = scene_of_azimuth.emplace(drawn.value, info.name);
            EXPECT_TRUE(is_new) << info.name << " has the lamp of " << other->second;
        }
    }
    EXPECT_GE(scene_of_azimuth.size(), 60U);
}

TEST(ScenesTest, TheSameSeedIsTheSameScene) {
    for (const SceneInfo& info : list_scenes()) {
        const ScriptedScene a = make_scene(info.name, 7).value();
        const ScriptedScene b = make_scene(info.name, 7).value();
        EXPECT_EQ(a.parameters, b.parameters) << info.name;
        const Lattice lattice{{-1.0, -2.0}, 60, 40, 0.1};
        const Image<float> dem_a = dem(a.scene, lattice);
        const Image<float> dem_b = dem(b.scene, lattice);
        // Bytes: NaN, where no ground is, equals itself.
        EXPECT_EQ(std::memcmp(dem_a.data(), dem_b.data(), dem_a.size() * sizeof(float)), 0)
            << info.name;
        EXPECT_EQ(a.motion->at(5.0).T_world_body.translation_m,
                  b.motion->at(5.0).T_world_body.translation_m);
    }
}

/// Labels that at least 1 in 500 rays of the left camera hit, from some point of the path.
std::set<Label> seen_labels(const ScriptedScene& script) {
    const camera::StereoRig rig = rig_preset("zed_vga").value();
    std::set<Label> seen;
    for (double share : {0.0, 0.5, 1.0}) {
        const Pose T_world_camera =
            script.motion->at(share * script.motion->duration_s()).T_world_body *
            rig.body_from_left();
        std::map<Label, int> count;
        int rays = 0;
        for (int v = 4; v < rig.left.height; v += 8) {
            for (int u = 4; u < rig.left.width; u += 8) {
                const auto ray = camera::unproject(rig.left.model, {u, v});
                ++rays;
                const auto hit = script.scene.intersect(
                    T_world_camera.translation_m, T_world_camera.rotation * ray->normalized());
                if (!hit) continue;
                ++count[script.scene.surfaces()[static_cast<std::size_t>(hit->surface)].label];
            }
        }
        for (const auto& [label, hits] : count) {
            if (hits * 500 >= rays) seen.insert(label);
        }
    }
    return seen;
}

TEST(ScenesTest, TheCameraSeesWhatTheSceneIsAbout) {
    const std::vector<std::pair<std::string, Label>> subjects{
        {"stairs", Label::step},      {"flight", Label::step},        {"spiral", Label::step},
        {"kerb_up", Label::kerb},     {"kerb_down", Label::drop},     {"kerb_ramp", Label::ramp},
        {"ramp_1", Label::ramp},      {"sill", Label::sill},          {"door", Label::door},
        {"table", Label::table},      {"overhang", Label::overhang},  {"hole", Label::drop},
        {"drop", Label::drop},        {"platform", Label::drop},      {"corridor", Label::door},
        {"room", Label::table},       {"demo", Label::step},          {"cross_fall", Label::floor},
        {"floor", Label::floor},      {"glass", Label::floor},        {"mirror", Label::floor},
        {"stripes", Label::floor},    {"shadow", Label::floor},       {"look", Label::step},
        {"hand", Label::step},        {"walk_back", Label::table},    {"walk_descend", Label::step},
        {"walk_ramp", Label::ramp},   {"walk_sidestep", Label::wall}, {"walk_turn", Label::table},
        {"walk_pivot", Label::floor}, {"walk_floor", Label::floor},   {"walk_look", Label::floor},
        {"thesis_a", Label::door},    {"thesis_b", Label::kerb},      {"thesis_f", Label::drop},
        {"thesis_h", Label::floor},   {"thesis_j", Label::object},    {"thesis_", Label::step},
    };
    for (const SceneInfo& info : list_scenes()) {
        const auto subject = std::find_if(subjects.begin(), subjects.end(), [&](const auto& entry) {
            return info.name.starts_with(entry.first);
        });
        ASSERT_NE(subject, subjects.end()) << "no subject known for " << info.name;
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            const auto seen = seen_labels(make_scene(info.name, seed).value());
            EXPECT_TRUE(seen.contains(subject->second)) << info.name << " seed " << seed;
            EXPECT_TRUE(seen.contains(Label::floor)) << info.name << " seed " << seed;
        }
    }
}

/// Data sets of Table 8.2 of the reference thesis (Lange 2016): length and width [m] of each place,
/// in either order.
TEST(ScenesTest, ThePlacesOfTheThesisHaveTheirSizeAndManyThings) {
    struct Place {
        const char* name;
        double long_m;
        double wide_m;
    };
    constexpr Place kPlaces[] = {{"thesis_a_household", 15, 14},
                                 {"thesis_b_roadside", 75, 40},
                                 {"thesis_c_angled_stairs", 7, 7},
                                 {"thesis_d_courtyard", 76, 58},
                                 {"thesis_e_large_stairs", 24, 17},
                                 {"thesis_f_ledges", 85, 66},
                                 {"thesis_g_single_stairs", 9, 8},
                                 {"thesis_h_hall", 39, 35},
                                 {"thesis_i_demo_stairs", 12, 12},
                                 {"thesis_j_office", 4, 4},
                                 {"thesis_k_production_stairs", 12, 4},
                                 {"thesis_l_reception", 11, 8},
                                 {"thesis_m_steep_stairs", 9, 5}};
    for (const Place& place : kPlaces) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            const ScriptedScene script = make_scene(place.name, seed).value();
            EXPECT_GE(script.solids, 30) << place.name;
            EXPECT_FALSE(script.stations_m.empty()) << place.name;
            Vector2d low_m = Vector2d::Constant(1e9);
            Vector2d high_m = -low_m;
            for (int i = 0; i < script.scene.primitives(); ++i) {
                for (const Vector3d& p_m : script.scene.hull(i)) {
                    low_m = low_m.cwiseMin(p_m.head<2>());
                    high_m = high_m.cwiseMax(p_m.head<2>());
                }
            }
            const Vector2d size_m = high_m - low_m;
            EXPECT_NEAR(size_m.maxCoeff(), place.long_m, 0.03 * place.long_m) << place.name;
            EXPECT_NEAR(size_m.minCoeff(), place.wide_m, 0.03 * place.wide_m) << place.name;
        }
    }
}

/// The motion model is a choice: each of the three models can follow the path of each place, except
/// for the flight, which only the hand-held camera climbs.
TEST(ScenesTest, EveryMotionModelCanGoThroughThePlacesOfTheThesis) {
    for (const SceneInfo& info : list_scenes()) {
        if (!info.name.starts_with("thesis_") || info.name.ends_with("_climbed")) continue;
        for (const MotionModel motion_model :
             {MotionModel::trolley, MotionModel::rex, MotionModel::hand}) {
            for (std::uint64_t seed = 1; seed <= 3; ++seed) {
                const auto script = make_scene(info.name, seed, motion_model);
                EXPECT_TRUE(script)
                    << info.name << " seed " << seed << ": " << script.error().message;
            }
        }
    }
}

/// Ground truth of a randomised scene: heights along the line through its subject.
class Figures {
  public:
    Figures(const std::string& name, std::uint64_t seed)
        : script_(make_scene(name, seed).value()) {}

    [[nodiscard]] double parameter(const std::string& name) const {
        return drawn_number(script_, name);
    }
    /// `along_m` behind the first edge, `across_m` to the left, in the turned frame of the subject.
    [[nodiscard]] double height_m(double along_m, double across_m) const {
        const double yaw_rad = parameter("angle_deg") * std::numbers::pi / 180.0;
        const double c = std::cos(yaw_rad);
        const double s = std::sin(yaw_rad);
        return script_.scene
            .height_at(parameter("distance_m") + c * along_m - s * across_m,
                       s * along_m + c * across_m)
            ->z_m;
    }

  private:
    ScriptedScene script_;
};

struct StairClass {
    const char* name;
    double rise_m;
    double going_m;
};

TEST(ScenesTest, StairsHaveTheFiguresOfTheirClass) {
    constexpr double kBeside_m = 1e-6;
    const std::vector<StairClass> classes{{"nz_service", 0.22, 0.22},
                                          {"nz_secondary", 0.20, 0.25},
                                          {"nz_common", 0.19, 0.28},
                                          {"nz_accessible", 0.18, 0.31},
                                          {"ada", 0.15, 0.28}};
    for (const StairClass& stair : classes) {
        for (const int direction : {1, -1}) {
            const std::string name =
                std::string(direction > 0 ? "stairs_up_" : "stairs_down_") + stair.name;
            for (std::uint64_t seed = 1; seed <= 5; ++seed) {
                const Figures figures(name, seed);
                const int steps = static_cast<int>(figures.parameter("steps"));
                for (int edge = 0; edge < steps; ++edge) {
                    const double along_m = edge * stair.going_m;
                    const double across_m = figures.parameter("lateral_m");
                    const double before_m = figures.height_m(along_m - kBeside_m, across_m);
                    const double behind_m = figures.height_m(along_m + kBeside_m, across_m);
                    EXPECT_NEAR(before_m, direction * edge * stair.rise_m, 1e-9)
                        << name << " seed " << seed << " edge " << edge;
                    EXPECT_NEAR(behind_m - before_m, direction * stair.rise_m, 1e-9)
                        << name << " seed " << seed << " edge " << edge;
                }
                const double end_m = (steps - 1) * stair.going_m + 0.5;
                EXPECT_NEAR(figures.height_m(end_m, figures.parameter("lateral_m")),
                            direction * steps * stair.rise_m,
                            1e-9)
                    << name << " seed " << seed;
            }
        }
    }
}

TEST(ScenesTest, TwentyStepsHaveALandingAfterTen) {
    for (const int direction : {1, -1}) {
        const Figures figures(direction > 0 ? "flight_20_up" : "flight_20_down", 4);
        const double across_m = figures.parameter("lateral_m");
        const double rise_m = figures.parameter("rise_m");
        const double going_m = figures.parameter("going_m");
        EXPECT_GE(rise_m, 0.17);
        EXPECT_LE(rise_m, 0.18);
        int edges = 0;
        double landing_m = 0.0;
        double last_edge_m = 0.0;
        double last_m = figures.height_m(-0.1, across_m);
        for (double along_m = -0.1; along_m < 18 * going_m + 1.2 + 0.3; along_m += 0.001) {
            const double now_m = figures.height_m(along_m, across_m);
            if (now_m == last_m) continue;
            EXPECT_NEAR(now_m - last_m, direction * rise_m, 1e-9) << "at " << along_m;
            last_m = now_m;
            if (++edges == 11) landing_m = along_m - last_edge_m;
            last_edge_m = along_m;
        }
        EXPECT_EQ(edges, 20);
        EXPECT_NEAR(landing_m, 1.2, 0.0021);
        EXPECT_NEAR(last_m, direction * 20 * rise_m, 1e-9);
    }
}

TEST(ScenesTest, KerbsRampsAndSillsHaveTheirFigures) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        for (const int height_mm : {75, 100, 150}) {
            const std::string mm = std::to_string(height_mm);
            const Figures up("kerb_up_" + mm, seed);
            const Figures down("kerb_down_" + mm, seed);
            for (const double across_m : {-0.8, 0.0, 0.8}) {
                EXPECT_NEAR(up.height_m(-1e-6, across_m), 0.0, 1e-9);
                EXPECT_NEAR(up.height_m(1e-6, across_m), 1e-3 * height_mm, 1e-9);
                EXPECT_NEAR(up.height_m(0.5, across_m), 1e-3 * height_mm, 1e-9);
                EXPECT_NEAR(down.height_m(-1e-6, across_m), 0.0, 1e-9);
                EXPECT_NEAR(down.height_m(1e-6, across_m), -1e-3 * height_mm, 1e-9);
            }
        }
        for (const auto& [name, slope] :
             std::map<std::string, double>{{"kerb_ramp_up", 1.0 / 8},
                                           {"kerb_ramp_down", -1.0 / 8},
                                           {"ramp_1_12_up", 1.0 / 12},
                                           {"ramp_1_12_down", -1.0 / 12}}) {
            const Figures figures(name, seed);
            const double across_m = figures.parameter("lateral_m");
            for (const double along_m : {0.0, 0.1, 0.3, 0.6}) {
                EXPECT_NEAR(figures.height_m(along_m, across_m), slope * along_m, 1e-9) << name;
            }
        }
        for (const int sill_mm : {6, 13, 20}) {
            const Figures figures("sill_" + std::to_string(sill_mm), seed);
            const double across_m = 0.3 * figures.parameter("lateral_m");
            EXPECT_NEAR(figures.height_m(-1e-6, across_m), 0.0, 1e-9);
            EXPECT_NEAR(figures.height_m(1e-6, across_m), 1e-3 * sill_mm, 1e-9);
            EXPECT_NEAR(figures.height_m(0.09, across_m), 1e-3 * sill_mm, 1e-9);
        }
        const Scene fall = make_scene("cross_fall", seed)->scene;
        const double left_m = fall.height_at(1.0, 1.0)->z_m;
        EXPECT_NEAR(std::abs(left_m), 1.0 / 50, 1e-9);
        EXPECT_NEAR(fall.height_at(1.0, -1.0)->z_m, -left_m, 1e-9);
        EXPECT_NEAR(fall.height_at(3.0, 1.0)->z_m, left_m, 1e-9);
    }
}

TEST(ScenesTest, ASceneFileCanBeGivenByItsPath) {
    const ScriptedScene built_in = make_scene("kerb_up_100", 3).value();
    const ScriptedScene from_file =
        make_scene("surefoot/sim/scene_files/kerb_up.yaml#kerb_up_100", 3).value();
    EXPECT_EQ(from_file.info.name, "kerb_up_100");
    EXPECT_EQ(from_file.parameters, built_in.parameters);
    EXPECT_EQ(make_scene("surefoot/sim/scene_files/table.yaml", 3)->info.name, "table");
    EXPECT_EQ(make_scene("no/such.yaml", 3).error().message,
              "no/such.yaml: cannot read: No such file or directory");
    const auto folder = make_scene("surefoot/sim/scene_files/kerb_up.yaml", 3);
    ASSERT_FALSE(folder);
    EXPECT_NE(folder.error().message.find("add '#NAME'"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::sim
