// SPDX-License-Identifier: Apache-2.0
#include "sim/imu.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/trolley_motion.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kStart_ns = kNanosecondsPerSecond;
constexpr ImuNoiseConfig kIdeal{0.0, 0.0, 0.0, 0.0};

TrolleyMotion tour() {
    return TrolleyMotion::trolley(
        {{0.0, 0.0, 0.0, 0.5}, {1.0, 0.4, 0.6, 0.1}, {1.0, 0.4, -0.4, 0.4}}, TrolleyConfig{});
}

camera::ImuMount turned_mount() {
    camera::ImuMount mount;
    mount.T_body_imu.rotation = exp_so3({0.4, -0.7, 0.2});
    mount.T_body_imu.translation_m = {0.3, -0.2, 0.1};
    return mount;
}

TEST(ImuTest, AtRestItFeelsGravityUpward) {
    const ImuModel imu(std::make_shared<TrolleyMotion>(TrolleyMotion::stand({}, 0.95, 1.0)),
                       {},
                       kIdeal,
                       kStart_ns,
                       1);
    const ImuSample sample = imu.ideal(kStart_ns);
    EXPECT_EQ(sample.specific_force_m_s2, Vector3d(0.0, 0.0, kGravity_m_s2));
    EXPECT_EQ(sample.angular_velocity_rad_s, Vector3d::Zero());
}

TEST(ImuTest, IntegrationReturnsTheTrajectory) {
    const TrolleyMotion trajectory = tour();
    const camera::ImuMount mount = turned_mount();
    const ImuModel imu(std::make_shared<TrolleyMotion>(trajectory), mount, kIdeal, kStart_ns, 1);
    constexpr double kStep_s = 0.001;
    Pose T_world_imu = trajectory.at(0.0).T_world_body * mount.T_body_imu;
    Vector3d velocity = Vector3d::Zero();
    const int steps = static_cast<int>(trajectory.duration_s() / kStep_s);
    double worst_m = 0.0;
    double worst_rad = 0.0;
    for (int i = 0; i < steps; ++i) {
        const ImuSample middle = imu.ideal(kStart_ns + ns_from_seconds((i + 0.5) * kStep_s));
        const Eigen::Quaterniond half =
            T_world_imu.rotation * exp_so3(0.5 * kStep_s * middle.angular_velocity_rad_s);
        const Vector3d acceleration =
            half * middle.specific_force_m_s2 - Vector3d(0.0, 0.0, kGravity_m_s2);
        T_world_imu.translation_m += kStep_s * velocity + 0.5 * kStep_s * kStep_s * acceleration;
        velocity += kStep_s * acceleration;
        T_world_imu.rotation =
            (T_world_imu.rotation * exp_so3(kStep_s * middle.angular_velocity_rad_s)).normalized();
        const Vector6 error = difference(
            trajectory.at((i + 1) * kStep_s).T_world_body * mount.T_body_imu, T_world_imu);
        worst_m = std::max(worst_m, error.head<3>().norm());
        worst_rad = std::max(worst_rad, error.tail<3>().norm());
    }
    // Midpoint rule: local error ~ jerk * step^3 / 24 with jerk < 3 m/s^3, summed over all steps
    // into velocity and position.
    const double bound_m = 3.0 * kStep_s * kStep_s * trajectory.duration_s();
    EXPECT_LT(worst_m, bound_m);
    EXPECT_LT(worst_rad, 1e-6);
}

TEST(ImuTest, SamplesFillIntervalsWithoutGapsOrRepeats) {
    const ImuModel imu(std::make_shared<TrolleyMotion>(tour()), {}, ImuNoiseConfig{}, kStart_ns, 3);
    const std::int64_t from_ns = kStart_ns - 100'000'000;
    const std::int64_t middle_ns = kStart_ns + 66'666'667;
    const std::int64_t to_ns = kStart_ns + 500'000'000;
    const auto all = imu.samples(from_ns, to_ns);
    auto parts = imu.samples(from_ns, middle_ns);
    for (const ImuSample& sample : imu.samples(middle_ns, to_ns)) parts.push_back(sample);
    ASSERT_EQ(all.size(), 120U);
    ASSERT_EQ(parts.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(all[i].time_ns, parts[i].time_ns);
        EXPECT_EQ(all[i].specific_force_m_s2, parts[i].specific_force_m_s2) << "sample " << i;
        if (i > 0) {
            EXPECT_EQ(all[i].time_ns - all[i - 1].time_ns, 5'000'000);
        }
    }
}

TEST(ImuTest, NoiseHasTheConfiguredDensity) {
    ImuNoiseConfig noise;
    noise.gyro_bias_sigma_rad_s = 0.0;
    noise.accel_bias_sigma_m_s2 = 0.0;
    const ImuModel imu(std::make_shared<TrolleyMotion>(TrolleyMotion::stand({}, 0.95, 1.0)),
                       {},
                       noise,
                       kStart_ns,
                       3);
    const auto samples = imu.samples(0, 50 * kNanosecondsPerSecond);
    double gyro2 = 0.0;
    double accel2 = 0.0;
    for (const ImuSample& sample : samples) {
        gyro2 += sample.angular_velocity_rad_s.squaredNorm() / 3.0;
        accel2 +=
            (sample.specific_force_m_s2 - Vector3d(0.0, 0.0, kGravity_m_s2)).squaredNorm() / 3.0;
    }
    const auto count = static_cast<double>(samples.size());
    const double root_rate = std::sqrt(200.0);
    // Five standard errors of a sigma estimated from 30 000 numbers: 2 %.
    EXPECT_NEAR(
        std::sqrt(gyro2 / count) / (noise.gyro_density_rad_s_sqrt_hz * root_rate), 1.0, 0.021);
    EXPECT_NEAR(
        std::sqrt(accel2 / count) / (noise.accel_density_m_s2_sqrt_hz * root_rate), 1.0, 0.021);
}

}  // namespace
}  // namespace surefoot::sim
