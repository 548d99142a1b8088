// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/flights/ray_scene_testing.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::flight;
using testing::Tread;

class Scene : public testing::RayScene {
  public:
    using RayScene::RayScene;
    [[nodiscard]] std::vector<Edge> find() const { return find(edge_); }
    [[nodiscard]] std::vector<Edge> find(const Edge& known) const {
        std::vector<Edge> found;
        RaySteps{StairsConfig{}}.find(terrain(), {&known, 1}, found);
        return found;
    }
};

TEST(RaySteps, treads_in_sight_as_strips_of_a_few_pixels_are_steps) {
    struct Case {
        double riser_m, going_m, distance_m, yaw_deg, roll_deg;
    };
    for (const Case& now : {Case{0.17, 0.29, 0.75, 0.0, 0.0},
                            Case{0.18, 0.28, 0.9, 12.0, 3.0},
                            Case{0.20, 0.235, 0.9, -8.0, -2.0},  // 8 pixels, 6 pixels
                            Case{0.15, 0.31, 0.67, 5.0, 1.0}}) {
        Scene scene(flight(6, now.riser_m, now.going_m),
                    now.distance_m,
                    now.yaw_deg * kRadPerDeg,
                    now.roll_deg * kRadPerDeg);
        scene.add_noise(0.3, 21);
        const std::vector<Edge> found = scene.find();
        ASSERT_GE(found.size(), 3U) << now.riser_m;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto step = static_cast<double>(k);
            EXPECT_NEAR(found[k].upper_m, -step * now.riser_m, 0.006) << now.riser_m << ' ' << k;
            EXPECT_NEAR(found[k].height_m(), now.riser_m, 0.008) << now.riser_m << ' ' << k;
            EXPECT_NEAR(found[k].middle_m().x(), step * now.going_m, 0.008)
                << now.riser_m << ' ' << k;
            EXPECT_TRUE(found[k].lower_seen);
        }
    }
}

TEST(RaySteps, steps_are_likelier_than_a_slope_and_a_slope_is_no_step) {
    const double proven = std::log(StairsConfig{}.step_ratio);
    for (std::uint64_t seed = 21; seed < 25; ++seed) {
        Scene steps(flight(6, 0.17, 0.29), 0.75, 0.1);
        steps.add_noise(0.3, seed);
        for (const Edge& edge : steps.find()) EXPECT_GE(edge.log_step_ratio, proven) << seed;
        for (const double slope_deg : {15.0, 22.0, 30.0, 35.0}) {
            // Many very low steps are a slope.
            constexpr double kPiece_m = 0.01;
            Scene slope(
                flight(300, kPiece_m * std::tan(slope_deg * kRadPerDeg), kPiece_m), 0.75, 0.1);
            slope.add_noise(0.3, seed);
            for (const Edge& edge : slope.find())
                EXPECT_LT(edge.log_step_ratio, proven) << slope_deg << " deg, seed " << seed;
        }
    }
}

/// A matcher blurs the change from tread to tread over 0.15 m of the second tread.
TEST(RaySteps, a_blurred_tread_ends_no_flight) {
    std::vector<Tread> treads = flight(6, 0.17, 0.27);
    treads.insert(treads.begin() + 1, {0.19, 0.26});
    treads[2] = {0.34, 0.34};
    Scene scene(treads, 0.8, 0.05);
    scene.add_noise(0.3, 23);
    const std::vector<Edge> found = scene.find();
    ASSERT_GE(found.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(found[k].height_m(), 0.17, 0.012) << k;
        EXPECT_NEAR(found[k].middle_m().x(), 0.27 * static_cast<double>(k), 0.03) << k;
    }
}

TEST(RaySteps, a_kerb_is_as_high_as_the_camera_sees_it) {
    Scene scene({{0.0, 0.12}}, 1.2, 6.0 * kRadPerDeg);
    scene.add_noise(0.3, 22);
    const std::vector<Edge> found = scene.find();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].height_m(), 0.12, 0.003);
    EXPECT_LT(found[0].height_sigma_m, 0.01);
    // Deeper ground in the map has priority.
    scene.edge_.lower_m = -0.4;
    EXPECT_DOUBLE_EQ(scene.find().at(0).height_m(), 0.4);
}

TEST(RaySteps, a_ramp_down_and_one_deep_fall_are_no_flights) {
    std::vector<Tread> ramp;
    for (int k = 0; k < 400; ++k) ramp.push_back({0.008 * k, 0.001 * (k + 1)});  // 1 : 8
    EXPECT_LE(Scene(ramp, 0.9, 0.0).find().size(), 1U);
    EXPECT_LE(Scene({{0.0, 0.75}}, 0.9, 0.0).find().size(), 1U);
    // Two treads; the second is no step of the same flight: too deep, or unlike the first.
    EXPECT_EQ(Scene({{0.0, 0.15}, {0.3, 0.6}}, 0.8, 0.0).find().size(), 1U);
    EXPECT_EQ(Scene({{0.0, 0.09}, {0.3, 0.31}}, 0.8, 0.0).find().size(), 1U);
    EXPECT_EQ(Scene({{0.0, 0.16}, {0.3, 0.32}}, 0.8, 0.0).find().size(), 2U);
}

TEST(RaySteps, what_is_not_seen_from_before_and_above_gives_nothing) {
    const auto treads = flight(5, 0.17, 0.29);
    Scene scene(treads, 0.8, 0.0);
    EXPECT_FALSE(scene.find().empty());
    Edge turned = scene.edge_;  // leads down towards the camera
    std::swap(turned.from_m, turned.to_m);
    EXPECT_TRUE(scene.find(turned).empty());
    Edge above = scene.edge_;
    above.upper_m = 1.1;
    EXPECT_TRUE(scene.find(above).empty());
    Edge elsewhere = scene.edge_;  // the ground does not change there
    elsewhere.from_m.x() = elsewhere.to_m.x() = -0.3;
    EXPECT_TRUE(scene.find(elsewhere).empty());
    Edge aside = scene.edge_;
    aside.from_m.y() += 5.0;
    aside.to_m.y() += 5.0;
    EXPECT_TRUE(scene.find(aside).empty());

    scene.disparity_px_.fill(std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(scene.find().empty());
    Terrain blind = scene.terrain();
    std::vector<Edge> found;
    RaySteps steps{StairsConfig{}};
    blind.disparity_px = {};
    steps.find(blind, {&scene.edge_, 1}, found);
    EXPECT_TRUE(found.empty());
    blind = Scene(treads, 0.8, 0.0).terrain();
    blind.view.reset();
    steps.find(blind, {&scene.edge_, 1}, found);
    EXPECT_TRUE(found.empty());
}

// Few, inconsistent matches on level ground and on treads add no step.
TEST(RaySteps, noise_of_two_pixels_and_gaps_add_no_step) {
    for (std::uint64_t seed = 21; seed < 27; ++seed) {
        for (const int steps : {1, 3}) {
            Scene scene(flight(steps, 0.17, 0.30), 0.8, 0.05);
            scene.add_noise(2.0, seed);
            Rng rng(seed);
            for (std::size_t i = 0; i < scene.disparity_px_.size(); ++i)
                if (rng.uniform() < 0.7)
                    scene.disparity_px_.data()[i] = std::numeric_limits<float>::quiet_NaN();
            const std::vector<Edge> found = scene.find();
            ASSERT_EQ(found.size(), static_cast<std::size_t>(steps)) << seed;
            for (const Edge& edge : found)
                EXPECT_NEAR(edge.height_m(), 0.17, 4.0 * edge.height_sigma_m) << seed;
        }
    }
}

TEST(RaySteps, disparities_of_noise_make_no_flight) {
    for (std::uint64_t seed = 21; seed < 25; ++seed) {
        Scene scene({}, 0.9, 0.0);
        Rng rng(seed);
        for (std::size_t i = 0; i < scene.disparity_px_.size(); ++i)
            scene.disparity_px_.data()[i] = static_cast<float>(1.0 + 60.0 * rng.uniform());
        EXPECT_LE(scene.find().size(), 1U) << seed;
    }
}

}  // namespace
}  // namespace surefoot::stairs
