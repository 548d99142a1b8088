// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/elevation_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr std::int64_t kFrame_ns = 66'666'667;

Pose body_at(double x_m, double y_m, double z_m = 1.0) {
    return {Eigen::Quaterniond::Identity(), {x_m, y_m, z_m}};
}

/// Points on a lattice of 5 mm over a square of flat ground, as measured from `T_odom_body` by a
/// sensor in the body's origin.
std::vector<MeasuredPoint> flat_patch(
    const Pose& T_odom_body, double x_m, double y_m, double z_m, float sigma_m = 0.005F) {
    std::vector<MeasuredPoint> points;
    for (int i = -10; i < 10; ++i) {
        for (int j = -10; j < 10; ++j) {
            const Eigen::Vector3d p_odom_m(x_m + 0.0025 + 0.005 * i, y_m + 0.0025 + 0.005 * j, z_m);
            points.push_back({(T_odom_body.inverse() * p_odom_m).cast<float>(),
                              sigma_m * sigma_m,
                              sigma_m * sigma_m});
        }
    }
    return points;
}

ElevationConfig exact_config() {
    ElevationConfig config;
    config.camera_tilt_sigma_rad = 0.0;
    config.reduction.systematic_sigma_m = 0.0;
    return config;
}

float at(const ElevationMap& map, const ElevationLayers::Layer& layer, double x_m, double y_m) {
    const auto cell = map.geometry().cell_at(x_m, y_m);
    return cell ? layer.at(cell->ix, cell->iy) : kNanF;
}
float height_at(const ElevationMap& map, double x_m, double y_m) {
    return at(map, map.layers().height_m, x_m, y_m);
}
float sigma_at(const ElevationMap& map, double x_m, double y_m) {
    return std::sqrt(at(map, map.layers().height_var_m2, x_m, y_m));
}

TEST(ElevationMap, StartsUnknownAndStaysSoWithoutPoints) {
    ElevationMap map({});
    EXPECT_EQ(map.geometry().nx, 240);
    EXPECT_EQ(map.known_cells(), 0);
    const FusionCounts counts = map.add_points({}, {}, body_at(0, 0), 0);
    EXPECT_EQ(counts.points, 0);
    EXPECT_EQ(counts.cells_measured, 0);
    EXPECT_EQ(map.known_cells(), 0);
}

TEST(ElevationMap, OnePatchBecomesItsCellsWithTheirVarianceTimeAndCount) {
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(0, 0);
    const auto points = flat_patch(T_odom_body, 1.0, 0.5, 0.03);
    const FusionCounts counts = map.add_points(points, {}, T_odom_body, 7 * kFrame_ns);
    EXPECT_EQ(counts.points, 400);
    EXPECT_EQ(counts.cells_measured, 16);  // 0.1 m over cells of 25 mm
    EXPECT_EQ(counts.cells_new, 16);
    EXPECT_EQ(map.known_cells(), 16);
    EXPECT_NEAR(height_at(map, 1.01, 0.51), 0.03F, 1e-6F);
    EXPECT_NEAR(sigma_at(map, 1.01, 0.51), 0.005F, 1e-6F);
    const auto cell = map.geometry().cell_at(1.01, 0.51);
    ASSERT_TRUE(cell);
    EXPECT_EQ(map.layers().count.at(cell->ix, cell->iy), 1U);
    EXPECT_EQ(map.layers().seen_ns.at(cell->ix, cell->iy), 7 * kFrame_ns);
    EXPECT_EQ(map.layers().horizontal_drift_m.at(cell->ix, cell->iy), 0.0F);
    EXPECT_TRUE(std::isnan(height_at(map, -1.0, 0.5)));
}

TEST(ElevationMap, HeightsAreExactFarFromTheOrigin) {
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(12345.678, -98765.432);
    map.follow(T_odom_body, Matrix6::Zero());
    const double x_m = 12346.5;
    const double y_m = -98765.0;
    const auto points = flat_patch(T_odom_body, x_m, y_m, -0.12);
    EXPECT_EQ(map.add_points(points, {}, T_odom_body, 0).outside, 0);
    EXPECT_EQ(map.known_cells(), 16);
    EXPECT_NEAR(height_at(map, x_m + 0.01, y_m + 0.01), -0.12F, 1e-6F);
}

TEST(ElevationMap, CellsStayAtTheirPlaceWhenTheWindowMoves) {
    ElevationMap map(exact_config());
    Pose T_odom_body = body_at(0, 0);
    map.add_points(flat_patch(T_odom_body, 1.0, 0.5, 0.03), {}, T_odom_body, 0);
    for (int step = 1; step <= 100; ++step) {
        T_odom_body = body_at(0.0347 * step, -0.01 * step);
        map.follow(T_odom_body, Matrix6::Zero());
        ASSERT_NEAR(height_at(map, 1.01, 0.51), 0.03F, 1e-6F) << "step " << step;
        ASSERT_EQ(map.known_cells(), 16) << "step " << step;
    }
    map.follow(body_at(5.0, 0.0), Matrix6::Zero());  // the patch is 4 m behind now
    EXPECT_EQ(map.known_cells(), 0);
    map.follow(body_at(0.0, 0.0), Matrix6::Zero());
    EXPECT_TRUE(std::isnan(height_at(map, 1.01, 0.51))) << "what left the window is forgotten";
}

TEST(ElevationMap, RememberedCellsPayForEveryMotionAndSeenOnesDoNot) {
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(0, 0);
    const auto near_patch = flat_patch(T_odom_body, 1.0, 0.0, 0.0);
    map.add_points(near_patch, {}, T_odom_body, 0);
    map.add_points(flat_patch(T_odom_body, -2.0, 0.0, 0.0), {}, T_odom_body, 0);
    Matrix6 covariance = Matrix6::Zero();
    covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 4e-6;  // 1 mm, 1 mrad, yaw 2 mrad
    constexpr int kFrames = 50;
    for (int frame = 0; frame < kFrames; ++frame) map.follow(T_odom_body, covariance);
    // Cell centre (-1.9875, 0.0125), 1 m under the body. Height: 1 mm and 1 mrad * 1.9875 m per
    // frame.
    const double height_var_m2 =
        2.5e-5 + kFrames * 1e-6 * (1.0 + 1.9875 * 1.9875 + 0.0125 * 0.0125);
    EXPECT_NEAR(sigma_at(map, -1.99, 0.01), std::sqrt(height_var_m2), 1e-5);
    // Largest horizontal error, across the line of sight: 1 mm, roll 1 mrad * 1 m, yaw 2 mrad *
    // 1.9875 m.
    const double drift_m = std::sqrt(kFrames * (1e-6 + 1e-6 + 4e-6 * 1.9875 * 1.9875));
    EXPECT_NEAR(at(map, map.layers().horizontal_drift_m, -1.99, 0.01), drift_m, 1e-5);

    map.add_points(near_patch, {}, T_odom_body, kFrame_ns);
    EXPECT_EQ(at(map, map.layers().horizontal_drift_m, 1.01, 0.01), 0.0F);
    EXPECT_NEAR(at(map, map.layers().horizontal_drift_m, -1.99, 0.01), drift_m, 1e-5);
}

TEST(ElevationMap, UnknownMotionOrPoseForgetsEverything) {
    for (const bool bad_pose : {false, true}) {
        ElevationMap map({});
        const Pose T_odom_body = body_at(0, 0);
        map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.0), {}, T_odom_body, 0);
        ASSERT_GT(map.known_cells(), 0);
        Matrix6 covariance = Matrix6::Zero();
        if (!bad_pose) covariance(0, 0) = std::numeric_limits<double>::infinity();
        const Pose nowhere = body_at(std::numeric_limits<double>::quiet_NaN(), 0);
        map.follow(bad_pose ? nowhere : T_odom_body, covariance);
        EXPECT_EQ(map.known_cells(), 0);
        EXPECT_EQ(map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.0), {}, nowhere, 0).cells_new,
                  0);
    }
}

TEST(ElevationMap, StandingStillNeitherLowersTheVarianceNorPullsTheHeight) {
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(0, 0);
    map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.0), {}, T_odom_body, 0);
    const float before_m = sigma_at(map, 1.01, 0.01);
    for (int frame = 1; frame <= 200;
         ++frame) {  // 4 mm off, smaller variance than before: still the same viewpoint
        map.add_points(
            flat_patch(T_odom_body, 1.0, 0.0, 0.004, 0.004F), {}, T_odom_body, frame * kFrame_ns);
    }
    EXPECT_EQ(sigma_at(map, 1.01, 0.01), before_m);
    EXPECT_EQ(height_at(map, 1.01, 0.01), 0.0F);
    EXPECT_EQ(map.layers().count.at(map.geometry().cell_at(1.01, 0.01)->ix,
                                    map.geometry().cell_at(1.01, 0.01)->iy),
              201U);
    // Drift while standing counts: the observation replaces an estimate that has become less
    // certain than the observation.
    Matrix6 covariance = Matrix6::Zero();
    covariance(2, 2) = 1e-4;
    map.follow(T_odom_body, covariance);
    map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.004), {}, T_odom_body, 300 * kFrame_ns);
    EXPECT_EQ(sigma_at(map, 1.01, 0.01), before_m);
    EXPECT_NEAR(height_at(map, 1.01, 0.01), 0.004F, 1e-6F);
}

TEST(ElevationMap, NewViewsLowerTheVarianceDownToItsFloor) {
    ElevationMap map(exact_config());
    for (int view = 0; view < 4; ++view) {
        const Pose T_odom_body = body_at(0.006 * view, 0);
        map.follow(T_odom_body, Matrix6::Zero());
        map.add_points(
            flat_patch(T_odom_body, 1.0, 0.0, 0.0, 0.01F), {}, T_odom_body, view * kFrame_ns);
    }
    EXPECT_NEAR(sigma_at(map, 1.01, 0.01), 0.01F / 2.0F, 1e-5F);  // four independent viewpoints
    for (int view = 4; view < 40; ++view) {
        const Pose T_odom_body = body_at(0.006 * view, 0);
        map.add_points(
            flat_patch(T_odom_body, 1.0, 0.0, 0.0, 0.01F), {}, T_odom_body, view * kFrame_ns);
    }
    EXPECT_NEAR(sigma_at(map, 1.01, 0.01), 0.003F, 1e-6F);
}

TEST(ElevationMap, SomethingThatAppearsTakesOverAndUntilThenTrustIsLow) {
    const ElevationConfig config = exact_config();
    ElevationMap map(config);
    const Pose T_odom_body = body_at(0, 0);
    map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.0), {}, T_odom_body, 0);
    const FusionCounts first =
        map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.3), {}, T_odom_body, 1);
    EXPECT_EQ(first.cells_inflated, 16);
    EXPECT_EQ(height_at(map, 1.01, 0.01), 0.0F);
    const float once_m = sigma_at(map, 1.01, 0.01);
    map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.3), {}, T_odom_body, 2);
    EXPECT_GT(sigma_at(map, 1.01, 0.01), 0.012F);
    EXPECT_GT(sigma_at(map, 1.01, 0.01), once_m);
    int frames = 2;
    while (height_at(map, 1.01, 0.01) < 0.29F && frames < 100) {
        map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.3), {}, T_odom_body, ++frames);
    }
    EXPECT_LE(frames, 26);  // (50 mm)^2 / (10 mm)^2, and one
    EXPECT_EQ(at(map, map.layers().lowest_m, 1.01, 0.01), 0.3F) << "extremes start anew";
}

TEST(ElevationMap, CountsWhatIsLeftOutAndWhy) {
    ElevationConfig config = exact_config();
    config.prefilter.outlier_removal = true;
    ElevationMap map(config);
    const Pose T_odom_body = body_at(0, 0);
    std::vector<MeasuredPoint> points = flat_patch(T_odom_body, 1.0, 0.0, 0.0);
    points.push_back({{0.1F, 0.0F, 0.0F}, 1e-4F, 1e-4F});    // nearer than 0.3 m
    points.push_back({{30.0F, 0.0F, 0.0F}, 1e-4F, 1e-4F});   // beyond 20 m
    points.push_back({{1.0F, 0.0F, 1.5F}, 1e-4F, 1e-4F});    // a lintel
    points.push_back({{2.0F, 2.0F, -1.0F}, 1e-4F, 1e-4F});   // alone
    points.push_back({{kNanF, 2.0F, -1.0F}, 1e-4F, 1e-4F});  // no measurement
    points.push_back({{1.0F, 0.0F, -1.0F}, kNanF, 1e-4F});   // no measurement
    for (int i = 0; i < 8; ++i)
        points.push_back({{5.0F, 0.01F * static_cast<float>(i), -1.0F}, 1e-4F, 1e-4F});
    const FusionCounts counts = map.add_points(points, {}, T_odom_body, 0);
    EXPECT_EQ(counts.points, 412);
    EXPECT_EQ(counts.gated_range, 2);
    EXPECT_EQ(counts.gated_height, 1);
    EXPECT_EQ(counts.gated_density, 1);
    EXPECT_EQ(counts.outside, 8);
    EXPECT_EQ(counts.cells_measured, 16);
}

TEST(ElevationMap, GroundBelowTheHeightCutIsADropAndNoHeight) {
    ElevationMap map(exact_config());
    const Pose T_odom_body = body_at(0, 0);
    const auto deep = flat_patch(T_odom_body, 1.0, 0.0, -2.5);  // 3.5 m below base_link
    const FusionCounts counts = map.add_points(deep, {}, T_odom_body, 0);
    EXPECT_EQ(counts.gated_height, 400);
    EXPECT_EQ(counts.cells_measured, 0);
    EXPECT_TRUE(std::isnan(at(map, map.layers().free_above_m, 1.01, 0.01))) << "one frame alone";
    map.add_points(deep, {}, T_odom_body, 1);
    EXPECT_EQ(map.known_cells(), 0);
    EXPECT_EQ(at(map, map.layers().free_above_m, 1.01, 0.01), -2.0F);
    // A known cell stays known: the map does not take the mirror image of a lamp for a pit.
    map.add_points(flat_patch(T_odom_body, 1.0, 0.0, 0.0), {}, T_odom_body, 2);
    for (int time_ns = 3; time_ns < 9; ++time_ns) map.add_points(deep, {}, T_odom_body, time_ns);
    EXPECT_EQ(height_at(map, 1.01, 0.01), 0.0F);
    EXPECT_TRUE(std::isnan(at(map, map.layers().free_above_m, 1.01, 0.01)));
}

TEST(ElevationMap, LinesOfSightShowDropsAsSurelyAsTheirEndsAreKnown) {
    // From 1 m up, half the lines to a patch 2 m ahead and 0.6 m below the floor are 0.2 m below
    // the floor at 1.5 m. A ray endpoint that may lie 0.9 m higher is no evidence of a drop.
    const Pose T_odom_body = body_at(0, 0);
    constexpr double kEnd_m = -0.6;
    const auto line_m = [](double end_m) { return static_cast<float>(1.0 - 0.75 * (1.0 - end_m)); };
    for (const float sigma_m : {0.005F, 0.3F}) {
        ElevationMap map(exact_config());
        const auto deep = flat_patch(T_odom_body, 2.0, 0.0, kEnd_m, sigma_m);
        for (int time_ns = 0; time_ns < 3; ++time_ns)
            map.add_points(deep, {}, T_odom_body, time_ns);
        ASSERT_TRUE(std::isnan(height_at(map, 1.51, 0.01)));
        EXPECT_NEAR(at(map, map.layers().free_above_m, 1.51, 0.01),
                    line_m(kEnd_m + 3.0 * static_cast<double>(sigma_m)),
                    0.05F)
            << sigma_m;
    }
}

TEST(ElevationMap, WrongMatchesThatNoOtherLookAgreesWithShowNoDrop) {
    // Each wrong match has a small sigma and another position; the lines of sight equal those of a
    // lower floor.
    const Pose T_odom_body = body_at(0, 0);
    ElevationMap map(exact_config());
    for (int i = 0; i < 6; ++i)
        map.add_points(flat_patch(T_odom_body, 1.8 + 0.15 * i, 0.0, -0.6), {}, T_odom_body, i);
    EXPECT_TRUE(std::isnan(at(map, map.layers().free_above_m, 1.51, 0.01)));
    // A wrong match in a cell with an agreed height shows no drop either.
    const auto floor = flat_patch(T_odom_body, 2.3, 0.0, 0.0);
    for (int i = 0; i < 3; ++i) map.add_points(floor, {}, T_odom_body, 6 + i);
    const float over_floor_m = at(map, map.layers().free_above_m, 1.51, 0.01);
    map.add_points(flat_patch(T_odom_body, 2.3, 0.0, -0.6), {}, T_odom_body, 9);
    map.add_points(flat_patch(T_odom_body, 2.3, 0.0, -0.7), {}, T_odom_body, 10);
    EXPECT_FLOAT_EQ(at(map, map.layers().free_above_m, 1.51, 0.01), over_floor_m);
}

/// Collects every key, and checks that defaults lie within their own ranges.
class KeyCollector : public ConfigVisitor {
  public:
    std::set<std::string> keys;

    void begin_group(const char* name) override { prefix_ += std::string(name) + "."; }
    void end_group() override { prefix_.erase(prefix_.rfind('.', prefix_.size() - 2) + 1); }
    void number(const char* key, double& value, double min, double max, const char*) override {
        EXPECT_TRUE(value >= min && value <= max) << key << " = " << value;
        add(key);
    }
    void integer(const char* key, int& value, int min, int max, const char*) override {
        EXPECT_TRUE(value >= min && value <= max) << key << " = " << value;
        add(key);
    }
    void boolean(const char* key, bool&, const char*) override { add(key); }
    void choice(const char* key,
                int& value,
                std::span<const char* const> names,
                const char*) override {
        EXPECT_LT(static_cast<std::size_t>(value), names.size()) << key;
        add(key);
    }

  private:
    void add(const char* key) { EXPECT_TRUE(keys.insert(prefix_ + key).second) << prefix_ << key; }
    std::string prefix_;
};

TEST(ElevationMap, ConfigurationDescribesItself) {
    ElevationConfig config;
    KeyCollector collector;
    config.describe(collector);
    for (const char* key : {"resolution_m",
                            "length_m",
                            "gate_sigma",
                            "sensor.model",
                            "prefilter.range",
                            "pixels.jump_px",
                            "viewpoint.min_translation_m",
                            "reduction.min_points"}) {
        EXPECT_EQ(collector.keys.count(key), 1U) << key;
    }
    EXPECT_FALSE(config.problem());
    config.length_m = 1000.0;
    ASSERT_TRUE(config.problem());
    EXPECT_NE(config.problem()->find("elevation.length_m = 1000"), std::string::npos)
        << *config.problem();
}

/// A machine that moves 0.1 m between its observations, so each of them counts; its camera is 1 m
/// over the ground.
class Overhead : public ::testing::Test {
  protected:
    /// Observes a patch of ground, and a patch where the lines of sight through the first patch at
    /// `through_m` end.
    void look(double z_m, std::optional<double> through_m = {}) {
        const Pose T_odom_body = body_at(0.1 * observations_ - 0.5, 0.0);
        const Eigen::Vector3d& camera_m = T_odom_body.translation_m;
        map_.follow(T_odom_body, 1e-9 * Matrix6::Identity());
        auto points = flat_patch(T_odom_body, 1.0, 0.0, z_m);
        if (through_m) {
            const double times = camera_m.z() / (camera_m.z() - *through_m);
            const double x_m = camera_m.x() + times * (1.0 - camera_m.x());
            for (int i = -2; i <= 2; ++i)
                for (const MeasuredPoint& p : flat_patch(T_odom_body, x_m + 0.1 * i, 0.0, 0.0))
                    points.push_back(p);
        }
        map_.add_points(points, Pose{}, T_odom_body, (observations_ + 1) * kFrame_ns);
        ++observations_;
    }
    [[nodiscard]] float clearance() const { return at(map_, map_.layers().clearance_m, 1.0, 0.0); }

    ElevationMap map_{exact_config()};
    int observations_ = 0;
};

TEST_F(Overhead, TwoSightingsOfATableTopBoundTheClearance) {
    for (int i = 0; i < 3; ++i) look(0.0);
    EXPECT_TRUE(std::isnan(clearance()));
    look(0.7);
    EXPECT_TRUE(std::isnan(clearance())) << "one may be a wrong match";
    look(0.72);
    EXPECT_NEAR(clearance(), 0.7F, 0.005F) << "the lower one counts";
    EXPECT_NEAR(height_at(map_, 1.0, 0.0), 0.0F, 0.002F);
}

TEST_F(Overhead, StaysWhileTheGroundUnderItIsSeen) {
    for (int i = 0; i < 3; ++i) look(0.0);
    look(0.4);
    look(0.4);
    ASSERT_NEAR(clearance(), 0.4F, 0.005F);
    for (int i = 0; i < 3; ++i) look(0.0);
    look(0.0, 0.2);  // lines that pass below it
    EXPECT_NEAR(clearance(), 0.4F, 0.005F);
}

TEST_F(Overhead, IsForgottenWhenLinesOfSightPassThroughIt) {
    look(0.0);
    look(0.4);
    look(0.0, 0.4);
    look(0.4);
    EXPECT_TRUE(std::isnan(clearance())) << "3 of 4 points of trust";
    look(0.4);
    EXPECT_FALSE(std::isnan(clearance()));
    look(0.0, 0.4);
    look(0.0, 0.4);
    EXPECT_TRUE(std::isnan(clearance()));
}

TEST_F(Overhead, AKerbHangsOverNothing) {
    for (int i = 0; i < 3; ++i) look(0.0);
    for (int i = 0; i < 3; ++i) look(0.15);
    EXPECT_TRUE(std::isnan(clearance()));
}

TEST_F(Overhead, WhatTheHeightWasStaysAboveTheGroundThatReplacesIt) {
    look(0.7);
    look(0.7);
    while (!(height_at(map_, 1.0, 0.0) < 0.5F)) {  // continues while the height is unknown
        ASSERT_LT(observations_, 40);
        look(0.0);
    }
    EXPECT_NEAR(clearance(), 0.7F, 0.005F);
    for (int i = 0; i < 9; ++i) look(0.0);
    EXPECT_NEAR(clearance(), 0.7F, 0.005F) << "it may hang there still";
}

TEST_F(Overhead, WhatOneLookAloneShowedHangsOverNothing) {
    look(0.7);
    while (!(height_at(map_, 1.0, 0.0) < 0.5F)) {
        ASSERT_LT(observations_, 40);
        look(0.0);
    }
    EXPECT_TRUE(std::isnan(clearance())) << "it may have been a wrong match";
}

}  // namespace
}  // namespace surefoot::elevation
