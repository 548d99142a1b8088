// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/gravity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kGravity_m_s2 = 9.81;

Direction direction(const Eigen::Vector3d& unit, double sigma_rad) {
    return {unit, sigma_rad * sigma_rad * (Eigen::Matrix3d::Identity() - unit * unit.transpose())};
}

/// Returns the z axis, tilted by small angles about x and y.
Eigen::Vector3d leant(double about_x_deg, double about_y_deg) {
    return exp_so3({about_x_deg * kRadPerDeg, about_y_deg * kRadPerDeg, 0.0}) *
           Eigen::Vector3d::UnitZ();
}

double between_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadPerDeg;
}

/// NEES of a direction, which has two unknowns.
double nees(const Direction& found, const Eigen::Vector3d& truth) {
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = found.unit_body.unitOrthogonal();
    across.col(1) = found.unit_body.cross(across.col(0));
    const Eigen::Vector2d error = across.transpose() * truth;
    return error.dot((across.transpose() * found.covariance * across).inverse() * error);
}

struct Outcome {
    double mean_deg = 0.0;  ///< mean of the error
    double nees_per_unknown = 0.0;
    double sigma_deg = 0.0;
};

/// Many starts: an accelerometer with a random bias, and a plane with an error of 0.1 deg, on
/// floors whose slope about x and y comes from `slope_deg(rng)`.
template <typename Slope>
Outcome many_starts(const Slope& slope_deg) {
    constexpr int kStarts = 4000;
    const GravityConfig config;
    const double accel_deg = config.accel_bias_m_s2 / kGravity_m_s2 / kRadPerDeg;
    constexpr double kPlane_deg = 0.1;
    Rng rng(5);
    Outcome outcome;
    for (int i = 0; i < kStarts; ++i) {
        const Eigen::Vector2d slope = slope_deg(rng);
        const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
        const FusedUp fused = fuse_up(
            config,
            direction(
                leant(slope.x() + kPlane_deg * rng.normal(), slope.y() + kPlane_deg * rng.normal()),
                kPlane_deg * kRadPerDeg),
            direction(leant(accel_deg * rng.normal(), accel_deg * rng.normal()),
                      accel_deg * kRadPerDeg));
        outcome.mean_deg += between_deg(fused.up.unit_body, up) / kStarts;
        outcome.nees_per_unknown += nees(fused.up, up) / 2.0 / kStarts;
        outcome.sigma_deg += fused.up.sigma_rad() / kRadPerDeg / kStarts;
    }
    return outcome;
}

TEST(FuseUp, ALevelFloorCorrectsTheAccelerometer) {
    const auto level = [](Rng&) { return Eigen::Vector2d(0.0, 0.0); };
    const Outcome outcome = many_starts(level);
    // The accelerometer alone errs by 0.117 deg about each axis, 0.146 deg on average.
    EXPECT_LT(outcome.mean_deg, 0.105);
    EXPECT_LT(outcome.sigma_deg, 0.10);
    EXPECT_LT(outcome.nees_per_unknown, 1.1);
}

/// A cross-fall of 1:50, a ramp of 2.9 deg, a ramp of 1:12: if they counted as level, they would
/// tilt the map by 20, 50 and 83 mm per metre.
TEST(FuseUp, ASlopeIsNotTakenForLevel) {
    for (const double slope : {1.146, 2.9, 4.76}) {
        SCOPED_TRACE(slope);
        const auto sloped = [slope](Rng&) { return Eigen::Vector2d(slope, 0.0); };
        const Outcome outcome = many_starts(sloped);
        EXPECT_LT(outcome.mean_deg, 0.16) << "3 mm a metre";
        EXPECT_GT(outcome.nees_per_unknown, 0.8);
        EXPECT_LT(outcome.nees_per_unknown, 1.25);
    }
}

TEST(FuseUp, StatesItsErrorOverAllFloors) {
    const GravityConfig config;
    const auto any = [&](Rng& rng) {
        const double sigma_deg =
            rng.uniform() < config.sloped_share ? config.sloped_floor_deg : config.level_floor_deg;
        return Eigen::Vector2d(sigma_deg * rng.normal(), sigma_deg * rng.normal());
    };
    const Outcome outcome = many_starts(any);
    EXPECT_NEAR(outcome.nees_per_unknown, 1.0, 0.1);
}

TEST(UpFromPlane, IsNoBetterKnownThanFloorsSlope) {
    const GravityConfig config;
    const Direction up = up_from_plane(config, direction(leant(0.0, 20.0), 0.1 * kRadPerDeg));
    EXPECT_NEAR(up.sigma_rad() / kRadPerDeg, std::hypot(config.sloped_floor_deg, 0.1), 1e-9);
    // The sigma_factor of the gate reaches a ramp of 1:12.
    constexpr double kSigmaFactor = 3.4;
    EXPECT_GE(kSigmaFactor * up.sigma_rad(), std::atan(1.0 / 12.0) - 1e-4);
}

std::vector<StereoFrame> with_force(const Eigen::Vector3d& force_m_s2,
                                    const Eigen::Vector3d& later_m_s2,
                                    const Eigen::Vector3d& gyro_rad_s) {
    StereoFrame frame;
    for (int i = 0; i < 20; ++i)
        frame.imu.push_back({i * 5'000'000, gyro_rad_s, i < 10 ? force_m_s2 : later_m_s2});
    return {frame};
}

std::optional<Direction> up_of(const std::vector<StereoFrame>& frames) {
    const Pose T_body_imu{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY())),
                          Eigen::Vector3d::Zero()};
    return up_from_imu({}, 0.15, 0.3, T_body_imu, frames);
}

TEST(UpFromImu, NeedsARigAtRest) {
    const Eigen::Vector3d force(-9.80, 0.0, 0.0);  // the IMU's -x axis points up
    const auto up = up_of(with_force(force, force, {0.02, 0.0, 0.08}));
    ASSERT_TRUE(up.has_value());
    EXPECT_LT((up->unit_body - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
    EXPECT_FALSE(up_of(with_force(force, force, {0.5, 0.0, 0.0}))) << "turning";
    EXPECT_FALSE(up_of(with_force(1.1 * force, 1.1 * force, Eigen::Vector3d::Zero())))
        << "accelerating";
    EXPECT_FALSE(up_of({})) << "no IMU";
}

TEST(UpFromImu, StatesWhatTheForceShowsOfItsError) {
    const auto sigma_deg = [](double length_m_s2, double turned_deg) {
        const Eigen::Vector3d force(-length_m_s2, 0.0, 0.0);
        const Eigen::Vector3d later = exp_so3({0.0, turned_deg * kRadPerDeg, 0.0}) * force;
        return up_of(with_force(force, later, Eigen::Vector3d::Zero()))->sigma_rad() / kRadPerDeg;
    };
    EXPECT_NEAR(sigma_deg(9.81, 0.0), std::sqrt(0.75) * 0.02 / 9.81 / kRadPerDeg, 1e-6);
    EXPECT_NEAR(sigma_deg(10.01, 0.0), 0.5 * 0.2 / 9.81 / kRadPerDeg, 0.03) << "a bias shows";
    EXPECT_GT(sigma_deg(9.81, 2.0), 0.9) << "it turned by 2 deg meanwhile";
}

}  // namespace
}  // namespace surefoot::pipeline
