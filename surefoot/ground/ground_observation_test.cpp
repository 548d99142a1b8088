// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_observation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/ground/frames_testing.hpp"
#include "surefoot/ground/ground_calibration.hpp"

namespace surefoot::ground {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double kNoise_m = 0.005;
constexpr double kSensorHeight_m = 1.0;
// The plane's one-sigma tilt is noise / (sqrt(n) extent) < 0.01 deg here. The choice per voxel and
// the limit at three sigma add to it.
constexpr double kTiltLimit_rad = 0.15 * kRadPerDeg;
constexpr double kHeightLimit_m = 0.004;

/// A world with the sensor at the origin and the floor 1 m below it.
class Scene {
  public:
    explicit Scene(std::uint64_t seed) : rng_(seed) {}

    /// `count` points on the parallelogram from `corner` along `a` and `b`, noise across it.
    Scene& patch(const Eigen::Vector3d& corner,
                 const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b,
                 int count) {
        const Eigen::Vector3d normal = a.cross(b).normalized();
        for (int i = 0; i < count; ++i) {
            points_.push_back(corner + rng_.uniform() * a + rng_.uniform() * b +
                              kNoise_m * rng_.normal() * normal);
        }
        return *this;
    }
    Scene& floor(int count) {
        return patch({0.5, -1.5, -kSensorHeight_m}, {3.0, 0, 0}, {0, 3.0, 0}, count);
    }
    Scene& wall(int count) { return patch({3.5, -1.5, -1.0}, {0, 3.0, 0}, {0, 0, 2.5}, count); }
    Scene& table(int count) { return patch({0.8, -0.5, -0.25}, {1.2, 0, 0}, {0, 1.0, 0}, count); }
    Scene& clutter(int count) {
        for (int i = 0; i < count; ++i) {
            points_.emplace_back(
                rng_.uniform(0.5, 3.5), rng_.uniform(-1.5, 1.5), rng_.uniform(-2.0, 1.5));
        }
        return *this;
    }
    /// All points in the frame of a body that is rotated by `rotation` in this world.
    [[nodiscard]] Points seen_by(const Eigen::Quaterniond& rotation) const {
        Points seen;
        for (const auto& p : points_) seen.push_back(rotation.conjugate() * p);
        return seen;
    }
    [[nodiscard]] Points points() const { return points_; }

  private:
    Rng rng_;
    Points points_;
};

GroundSighting sight(const Points& points, const GroundConfig& config = {}) {
    return sight_ground(config, points, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero(), 1);
}

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

void expect_floor(const GroundSighting& sighting) {
    EXPECT_TRUE(sighting.observation.accepted) << to_string(sighting.reason);
    EXPECT_EQ(sighting.reason, GroundReason::accepted);
    EXPECT_LE(angle_rad(sighting.observation.normal, Eigen::Vector3d::UnitZ()), kTiltLimit_rad);
    EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, kHeightLimit_m);
}

TEST(GroundObservation, DegenerateInputIsRejectedWithAReason) {
    EXPECT_EQ(sight({}).reason, GroundReason::few_points);
    EXPECT_EQ(sight({{1, 0, -1}}).reason, GroundReason::few_points);
    EXPECT_EQ(sight(Points(500, Eigen::Vector3d(1, 0, -1))).reason, GroundReason::few_points);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(sight(Points(500, Eigen::Vector3d(nan, 0, -1))).reason, GroundReason::few_points);
    Points line;
    for (int i = 0; i < 200; ++i) line.emplace_back(0.03 * i, 0.0, -1.0);
    EXPECT_EQ(sight(line).reason, GroundReason::no_plane);
    const Points floor = Scene(1).floor(500).points();
    for (const Eigen::Vector3d& hint : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(nan, 0, 1)}) {
        const auto sighting = sight_ground({}, floor, hint, Eigen::Vector3d::Zero(), 1);
        EXPECT_EQ(sighting.reason, GroundReason::no_hint);
        EXPECT_FALSE(sighting.observation.accepted);
    }
}

TEST(GroundObservation, FloorAloneIsFound) {
    const auto sighting = sight(Scene(2).floor(3000).points());
    expect_floor(sighting);
    EXPECT_GT(sighting.observation.inlier_ratio, 0.99);
    EXPECT_NEAR(sighting.observation.rms_m, kNoise_m, 0.2 * kNoise_m);
    EXPECT_NEAR(sighting.area_m2, 9.0, 2.5);
}

TEST(GroundObservation, TiltIsMeasured) {
    for (const double tilt_deg : {2.0, 5.0, 10.0}) {
        // The body is tilted forward by the tilt and to its side by half of it.
        const Eigen::Quaterniond R_world_body = exp_so3({0.0, tilt_deg * kRadPerDeg, 0.0}) *
                                                exp_so3({0.5 * tilt_deg * kRadPerDeg, 0.0, 0.0});
        const Points points = Scene(3).floor(2000).wall(1000).seen_by(R_world_body);
        const GroundSighting sighting = sight(points);
        ASSERT_TRUE(sighting.observation.accepted) << tilt_deg << ' ' << to_string(sighting.reason);
        const Eigen::Vector3d up_body = R_world_body.conjugate() * Eigen::Vector3d::UnitZ();
        EXPECT_LE(angle_rad(sighting.observation.normal, up_body), kTiltLimit_rad) << tilt_deg;
        EXPECT_NEAR(
            sighting.tilt_rad, angle_rad(up_body, Eigen::Vector3d::UnitZ()), kTiltLimit_rad);
        EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, kHeightLimit_m) << tilt_deg;
    }
}

TEST(GroundObservation, FloorBeyondTheTiltLimitIsNoGround) {
    const Points points = Scene(4).floor(3000).seen_by(exp_so3({0.0, 25.0 * kRadPerDeg, 0.0}));
    EXPECT_EQ(sight(points).reason, GroundReason::no_plane);
    GroundConfig wide;
    wide.max_tilt_deg = 30.0;
    EXPECT_TRUE(sight(points, wide).observation.accepted);
}

TEST(GroundObservation, WallAloneIsRejected) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const GroundSighting sighting = sight(Scene(seed).wall(4000).points());
        EXPECT_FALSE(sighting.observation.accepted)
            << "seed " << seed << " ratio " << sighting.observation.inlier_ratio;
    }
}

TEST(GroundObservation, FloorIsFoundBesideLargerWalls) {
    expect_floor(sight(Scene(5)
                           .floor(1500)
                           .wall(4000)
                           .patch({0.5, 1.5, -1.0}, {3.0, 0, 0}, {0, 0, 2.5}, 4000)
                           .points()));
}

TEST(GroundObservation, FloorWinsOverATableTopWithMorePoints) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        // The floor is visible only behind and beside the table.
        const Points points = Scene(seed)
                                  .table(6000)
                                  .patch({2.6, -1.2, -1.0}, {0.9, 0, 0}, {0, 2.4, 0}, 400)
                                  .points();
        SCOPED_TRACE("seed " + std::to_string(seed));
        const GroundSighting sighting = sight(points);
        EXPECT_TRUE(sighting.observation.accepted);
        EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, 0.03);
    }
}

TEST(GroundObservation, OfTwoFloorsTheOneThatFitsTheKnownHeightWins) {
    // The machine stands on a platform above the floor ahead; the floor has more points.
    for (const double rise_m : {0.17, 0.6}) {
        const Points points =
            Scene(31)
                .patch({0.5, -1.5, -kSensorHeight_m}, {1.0, 0, 0}, {0, 3.0, 0}, 1500)
                .patch({1.7, -1.5, -kSensorHeight_m - rise_m}, {3.0, 0, 0}, {0, 3.0, 0}, 4500)
                .points();
        const bool is_step = rise_m < 0.35;
        GroundConfig config;
        EXPECT_NEAR(sight(points, config).observation.height_m,
                    kSensorHeight_m + (is_step ? 0.0 : rise_m),
                    kHeightLimit_m)
            << "the lowest plane; a step lower, it is not the machine's ground";
        config.expected_height_m = kSensorHeight_m + 0.04;  // typical precision of a known mount
        const auto known = sight(points, config).observation;
        ASSERT_TRUE(known.accepted);
        EXPECT_NEAR(known.height_m, kSensorHeight_m, kHeightLimit_m);
    }
}

/// Frames of a camera with known noise.
void expect_ground(const std::vector<test::Surface>& surfaces,
                   double tilt_limit_deg,
                   double height_limit_m) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const auto ground =
            observe_ground({}, test::seen(surfaces, {.seed = seed}), Eigen::Vector3d::UnitZ(), seed)
                .observation;
        ASSERT_TRUE(ground.accepted) << "seed " << seed;
        EXPECT_LE(angle_rad(ground.normal, Eigen::Vector3d::UnitZ()), tilt_limit_deg * kRadPerDeg)
            << "seed " << seed;
        EXPECT_NEAR(ground.height_m, kSensorHeight_m, height_limit_m) << "seed " << seed;
    }
}

TEST(GroundObservation, BareFloorOfANoisyCamera) {
    expect_ground({{}}, 0.15, 0.003);
}

TEST(GroundObservation, OneLevelOfAKerb) {
    for (const double kerb_m : {0.075, -0.075, 0.1, -0.1, 0.15, -0.15}) {
        for (const double at_m : {1.1, 1.4, 2.0}) {
            SCOPED_TRACE(std::to_string(kerb_m) + " at " + std::to_string(at_m));
            expect_ground({{.max_x_m = at_m}, {.z_m = kerb_m, .min_x_m = at_m}}, 0.3, 0.005);
        }
    }
}

TEST(GroundObservation, StairsAndATableBeforeANoisyCamera) {
    std::vector<test::Surface> up{{.max_x_m = 1.2}};
    std::vector<test::Surface> down{{.max_x_m = 1.2}};
    for (int i = 1; i <= 5; ++i) {
        const double from_m = 1.2 + 0.28 * (i - 1);
        const double to_m = i == 5 ? 10.0 : from_m + 0.28;
        up.push_back({.z_m = 0.17 * i, .min_x_m = from_m, .max_x_m = to_m});
        down.push_back({.z_m = -0.17 * i, .min_x_m = from_m, .max_x_m = to_m});
    }
    expect_ground(up, 0.3, 0.005);
    expect_ground(down, 0.3, 0.005);
    // The table top fills more of the view than the floor.
    expect_ground(
        {{}, {.z_m = 0.55, .min_x_m = 0.45, .max_x_m = 1.2, .min_y_m = -0.35, .max_y_m = 0.8}},
        0.3,
        0.005);
}

TEST(GroundObservation, FramesOfANoisyCameraAgreeOnTheFloorBeforeARamp) {
    // The first decimetre of the ramp lies within the noise: the plane of a single frame may cross
    // it.
    for (const double rise : {1.0 / 12.0, -1.0 / 12.0, 0.125, -0.125}) {
        SCOPED_TRACE(rise);
        GroundCalibration calibration({});
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            calibration.add(observe_ground(
                {},
                test::seen({{.max_x_m = 1.4}, {.z_m = -1.4 * rise, .min_x_m = 1.4, .rise = rise}},
                           {.seed = seed}),
                Eigen::Vector3d::UnitZ(),
                seed));
        }
        const GroundAlignment alignment = calibration.alignment();
        EXPECT_TRUE(alignment.accepted);
        EXPECT_LE(alignment.tilt_rad, 0.5 * kRadPerDeg);
        EXPECT_NEAR(alignment.height_m, kSensorHeight_m, 0.008);
    }
}

TEST(GroundObservation, FloorWinsOverTheRampThatStartsAhead) {
    const double rise = std::tan(10.0 * kRadPerDeg);
    for (const double sign : {1.0, -1.0}) {        // up and down
        for (const double share : {0.33, 0.67}) {  // ramp larger, floor larger
            const double edge_m = 0.5 + 3.0 * share;
            const double length_m = 3.0 * (1.0 - share);
            const Points points =
                Scene(6)
                    .patch({0.5, -1.0, -1.0}, {edge_m - 0.5, 0, 0}, {0, 2.0, 0}, 1500)
                    .patch({edge_m, -1.0, -1.0},
                           {length_m, 0, sign * length_m * rise},
                           {0, 2.0, 0},
                           1500)
                    .points();
            SCOPED_TRACE((sign > 0.0 ? "up, share of floor " : "down, share of floor ") +
                         std::to_string(share));
            const GroundSighting sighting = sight(points);
            EXPECT_TRUE(sighting.observation.accepted);
            // 15 mm (three sigma) of the ramp count as floor: its first 85 mm, beside 1 m of floor.
            EXPECT_LE(sighting.tilt_rad, 1.0 * kRadPerDeg);
            EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, 0.015);
        }
    }
}

TEST(GroundObservation, HalfOutliersDoNotMatter) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const GroundSighting sighting = sight(Scene(seed).floor(2000).clutter(2000).points());
        EXPECT_TRUE(sighting.observation.accepted) << to_string(sighting.reason);
        // Clutter within three sigma of the plane is less than 1 % of its inliers.
        EXPECT_LE(angle_rad(sighting.observation.normal, Eigen::Vector3d::UnitZ()),
                  2.0 * kTiltLimit_rad);
        EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, kHeightLimit_m);
    }
}

TEST(GroundObservation, ClutterAloneIsRejected) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        EXPECT_FALSE(sight(Scene(seed).clutter(4000).points()).observation.accepted)
            << "seed " << seed;
    }
}

TEST(GroundObservation, SmallPatchesAreRejected) {
    const Points mat = Scene(7).patch({0.6, -0.2, -1.0}, {0.4, 0, 0}, {0, 0.4, 0}, 2000).points();
    EXPECT_EQ(sight(mat).reason, GroundReason::small);
    const Points plank = Scene(8).patch({0.6, -2.0, -1.0}, {0.2, 0, 0}, {0, 4.0, 0}, 4000).points();
    EXPECT_EQ(sight(plank).reason, GroundReason::small)
        << "area enough, but no width to fix the tilt";
}

TEST(GroundObservation, CeilingAndFloorAtAWrongHeightAreNoGround) {
    const Points ceiling =
        Scene(9).patch({0.5, -1.5, 1.4}, {3.0, 0, 0}, {0, 3.0, 0}, 3000).points();
    EXPECT_EQ(sight(ceiling).reason, GroundReason::no_plane);
    GroundConfig config;
    config.max_height_m = 0.8;
    EXPECT_EQ(sight(Scene(10).floor(3000).points(), config).reason, GroundReason::no_plane);
}

TEST(GroundObservation, RoughGroundIsRejected) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Rng rng(seed);
        Points gravel;
        for (int i = 0; i < 4000; ++i) {
            gravel.emplace_back(
                rng.uniform(0.5, 3.5), rng.uniform(-1.5, 1.5), -1.0 + rng.uniform(-0.1, 0.1));
        }
        EXPECT_EQ(sight(gravel).reason, GroundReason::rough) << "seed " << seed;
    }
}

TEST(GroundObservation, HeightIsTakenFromTheSensorInAnyFrame) {
    // Optical frame (y down), its origin not at the sensor.
    const Eigen::Vector3d shift_m(0.3, -0.4, 2.0);
    Points optical;
    for (const auto& p : Scene(12).floor(3000).points()) {
        optical.push_back(T_body_optical().rotation.conjugate() * p + shift_m);
    }
    const auto sighting = sight_ground({}, optical, Eigen::Vector3d(0, -3, 0), shift_m, 1);
    ASSERT_TRUE(sighting.observation.accepted);
    EXPECT_LE(angle_rad(sighting.observation.normal, -Eigen::Vector3d::UnitY()), kTiltLimit_rad);
    EXPECT_NEAR(sighting.observation.height_m, kSensorHeight_m, kHeightLimit_m);
}

TEST(GroundObservation, SameSeedGivesTheSameBytesAndAnotherSeedTheSameGround) {
    const FramePoints seen = test::seen({{}, {.z_m = 0.5, .min_x_m = 1.0}});
    const auto first = observe_ground({}, seen, Eigen::Vector3d::UnitZ(), 1).observation;
    const auto again = observe_ground({}, seen, Eigen::Vector3d::UnitZ(), 1).observation;
    const auto other = observe_ground({}, seen, Eigen::Vector3d::UnitZ(), 2).observation;
    ASSERT_TRUE(first.accepted && other.accepted);
    EXPECT_EQ(first.normal, again.normal);
    EXPECT_EQ(first.height_m, again.height_m);
    EXPECT_LE(angle_rad(first.normal, other.normal), kTiltLimit_rad);
    EXPECT_NEAR(first.height_m, other.height_m, kHeightLimit_m);
}

}  // namespace
}  // namespace surefoot::ground
