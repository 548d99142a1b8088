// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/sensor_variance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

constexpr double kZedDepthToDisparity = 41.031;  // 341.925 px * 0.12 m

SensorConfig with(SensorModel model) {
    SensorConfig config;
    config.model = model;
    config.min_var_m2 = 0.0;
    return config;
}

SensorReading straight_ahead(double depth_m) {
    SensorReading reading;
    reading.depth_m = depth_m;
    reading.range_m = depth_m;
    reading.disparity_sigma_px = 0.25;
    reading.column_px = 335.5;
    reading.row_px = 187.5;
    reading.principal_row_px = 187.5;
    reading.focal_px = 341.925;
    reading.depth_to_disparity_px_m = kZedDepthToDisparity;
    return reading;
}

TEST(SensorVariance, MatcherGives6And24MillimetresAt1And2Metres) {
    // z^2 sigma_d / (f b) with sigma_d = 0.25 px: 6.09 mm at 1 m, four times that at 2 m.
    const SensorConfig config = with(SensorModel::matcher);
    EXPECT_NEAR(
        std::sqrt(ray_variance(config, straight_ahead(1.0)).along_m2), 0.25 / 41.031, 1e-12);
    EXPECT_NEAR(std::sqrt(ray_variance(config, straight_ahead(2.0)).along_m2), 1.0 / 41.031, 1e-12);
    // Half a pixel at 1 m is 1.46 mm.
    EXPECT_NEAR(
        std::sqrt(ray_variance(config, straight_ahead(1.0)).lateral_m2), 0.5 / 341.925, 1e-12);
    // An oblique ray is longer than its depth by range / depth.
    SensorReading oblique = straight_ahead(1.0);
    oblique.range_m = 1.25;
    EXPECT_NEAR(std::sqrt(ray_variance(config, oblique).along_m2), 1.25 * 0.25 / 41.031, 1e-12);
}

TEST(SensorVariance, PerfectIsZeroAndTheFloorApplies) {
    SensorConfig config = with(SensorModel::perfect);
    EXPECT_EQ(ray_variance(config, straight_ahead(3.0)).along_m2, 0.0);
    config.min_var_m2 = 1e-8;
    EXPECT_EQ(ray_variance(config, straight_ahead(3.0)).along_m2, 1e-8);
    EXPECT_EQ(ray_variance(config, straight_ahead(3.0)).lateral_m2, 1e-8);
}

TEST(SensorVariance, LaserAfterPomerleau) {
    const RayVariance at_10_m = ray_variance(with(SensorModel::laser), straight_ahead(10.0));
    EXPECT_NEAR(std::sqrt(at_10_m.along_m2), 0.018, 1e-15);
    EXPECT_NEAR(std::sqrt(at_10_m.lateral_m2), 0.0015 + 0.0006 * 10.0, 1e-15);
}

TEST(SensorVariance, KinectAfterNguyen) {
    SensorConfig config = with(SensorModel::kinect);
    // 0.0012 + 0.0019 (2 - 0.4)^2 = 6.064 mm; across 0.001376915 * 2 = 2.754 mm.
    EXPECT_NEAR(std::sqrt(ray_variance(config, straight_ahead(2.0)).along_m2), 0.006064, 1e-12);
    EXPECT_NEAR(std::sqrt(ray_variance(config, straight_ahead(2.0)).lateral_m2), 0.00275383, 1e-12);
    config.kinect_d = 0.001;
    config.kinect_e = 3.0;
    EXPECT_NEAR(std::sqrt(ray_variance(config, straight_ahead(2.0)).along_m2), 0.014064, 1e-12);
}

TEST(SensorVariance, KellerAtAPixelWorkedOutByHand) {
    // z = 1 m: d = 47.3; column 0.485 * 47.3 + 399.1046 - 410.0451 = 12, row 5: distance 13.
    SensorReading reading = straight_ahead(1.0);
    reading.column_px = 410.0451;
    reading.row_px = 182.5;
    const double bracket = (0.000006735 * 47.3 - 0.0001276) * 13.0 + 0.03287;
    const RayVariance variance = ray_variance(with(SensorModel::stereo), reading);
    EXPECT_NEAR(variance.along_m2, bracket / (47.3 * 47.3), 1e-15);
    EXPECT_NEAR(variance.lateral_m2, 0.001376915 * 0.001376915, 1e-18);
}

TEST(SensorVariance, KellerIsClampedWhereThePublishedSetIsNegative) {
    SensorConfig config = with(SensorModel::stereo);
    config.min_var_m2 = 1e-8;
    SensorReading corner = straight_ahead(6.0);  // d = 7.9 px: p5 d + p2 = -7.5e-5 < 0
    corner.column_px = 0.0;
    corner.row_px = 375.0;  // 443 px from the centre: -0.033 + 0.03287 < 0
    EXPECT_EQ(ray_variance(config, corner).along_m2, 1e-8);
}

TEST(SensorVariance, SimplifiedStereoGives11Point6MillimetresAt1Metre) {
    // e = -2 / (41 + 2), a quarter of it: 11.63 mm.
    SensorReading reading = straight_ahead(1.0);
    reading.depth_to_disparity_px_m = 41.0;
    const RayVariance variance = ray_variance(with(SensorModel::simplified_stereo), reading);
    EXPECT_NEAR(std::sqrt(variance.along_m2), 2.0 / 43.0 / 4.0, 1e-15);
    EXPECT_NEAR(std::sqrt(variance.along_m2), 0.0116, 0.00005);
    EXPECT_NEAR(std::sqrt(variance.lateral_m2), 0.001376915, 1e-15);
}

TEST(SensorVariance, BasicIsAHeightVarianceInEveryDirection) {
    const RayVariance variance = ray_variance(with(SensorModel::basic), straight_ahead(2.0));
    EXPECT_NEAR(variance.along_m2, 0.0010 + 0.0030 * 2.0, 1e-15);
    EXPECT_EQ(variance.along_m2, variance.lateral_m2);
}

TEST(SensorVariance, UnknownStaysUnknownInEveryModel) {
    SensorReading reading = straight_ahead(1.0);
    reading.depth_m = reading.range_m = std::numeric_limits<double>::quiet_NaN();
    for (int model = 0; model <= static_cast<int>(SensorModel::basic); ++model) {
        const SensorConfig config = with(static_cast<SensorModel>(model));
        const RayVariance variance = ray_variance(config, reading);
        EXPECT_TRUE(std::isnan(variance.along_m2) || std::isnan(variance.lateral_m2))
            << "model " << model;
    }
}

TEST(SensorVariance, HeightVarianceMatchesNumericJacobiansOfPointAndPose) {
    Rng rng(11);
    const auto random_vector = [&](double scale) -> Eigen::Vector3d {
        return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()) * scale;
    };
    constexpr double kStep = 1e-6;
    for (int trial = 0; trial < 50; ++trial) {
        const Pose T_odom_sensor{exp_so3(random_vector(1.0)), random_vector(2.0)};
        const Eigen::Vector3d p_m = random_vector(1.5) + Eigen::Vector3d(0, 0, 0.1);
        const RayVariance ray{rng.uniform(1e-6, 1e-4), rng.uniform(1e-7, 1e-5)};
        Matrix6 A;
        for (int i = 0; i < 36; ++i) A.data()[i] = 0.01 * rng.normal();
        const Matrix6 pose_covariance = A * A.transpose();

        const Eigen::Vector3d along = p_m.normalized();
        const Eigen::Matrix3d sensor_covariance =
            ray.along_m2 * along * along.transpose() +
            ray.lateral_m2 * (Eigen::Matrix3d::Identity() - along * along.transpose());
        Eigen::RowVector3d J_point;
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
            const Eigen::Vector3d up = T_odom_sensor * Eigen::Vector3d(p_m + step);
            const Eigen::Vector3d down = T_odom_sensor * Eigen::Vector3d(p_m - step);
            J_point(i) = (up.z() - down.z()) / (2.0 * kStep);
        }
        Eigen::Matrix<double, 1, 6> J_pose;
        for (int i = 0; i < 6; ++i) {
            const Vector6 step = kStep * Vector6::Unit(i);
            J_pose(i) = ((perturbed(T_odom_sensor, step) * p_m).z() -
                         (perturbed(T_odom_sensor, -step) * p_m).z()) /
                        (2.0 * kStep);
        }
        const double expected_m2 = (J_point * sensor_covariance * J_point.transpose()).value() +
                                   (J_pose * pose_covariance * J_pose.transpose()).value();
        const Eigen::Vector3d up_sensor = T_odom_sensor.R().row(2).transpose();
        // Central differences are exact to about step^2 relative.
        EXPECT_NEAR(height_variance_m2(ray, p_m, up_sensor, pose_covariance),
                    expected_m2,
                    1e-7 * expected_m2)
            << "trial " << trial;
    }
}

}  // namespace
}  // namespace surefoot::elevation
