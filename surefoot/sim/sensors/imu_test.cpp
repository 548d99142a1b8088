// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/imu.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/sim/motion/trolley_motion.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kStart_ns = kNanosecondsPerSecond;
constexpr ImuNoiseConfig kIdeal{.gyro_density_rad_s_sqrt_hz = 0.0,
                                .accel_density_m_s2_sqrt_hz = 0.0,
                                .gyro_bias_sigma_rad_s = 0.0,
                                .accel_bias_sigma_m_s2 = 0.0};

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

ImuModel standing(const ImuNoiseConfig& noise, std::uint64_t seed) {
    return ImuModel(std::make_shared<TrolleyMotion>(TrolleyMotion::stand({}, 0.95, 1.0)),
                    {},
                    noise,
                    kStart_ns,
                    seed);
}

/// Steps of a random walk are independent and of unit variance, also across powers of two, and sums
/// of n of them have variance n: mean over many seeds.
TEST(ImuTest, RandomWalkHasIndependentUnitSteps) {
    constexpr int kSeeds = 4000;
    constexpr int kEnd = 37;
    std::vector<double> step2(kEnd + 1, 0.0);
    std::vector<double> product(kEnd + 1, 0.0);
    double end2 = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        double before = 0.0;
        for (std::int64_t n = 1; n <= kEnd; ++n) {
            const double step = random_walk(seed, n) - random_walk(seed, n - 1);
            step2[static_cast<std::size_t>(n)] += step * step / kSeeds;
            product[static_cast<std::size_t>(n)] += step * before / kSeeds;
            before = step;
        }
        const double back = random_walk(seed, -kEnd);
        end2 += back * back / (kEnd * kSeeds);
    }
    // Five standard errors: of a variance 5 sqrt(2 / n), of a product 5 / sqrt(n).
    const double bound = 5.0 / std::sqrt(static_cast<double>(kSeeds));
    for (std::size_t n = 1; n <= kEnd; ++n) {
        EXPECT_NEAR(step2[n], 1.0, std::sqrt(2.0) * bound) << "step " << n;
        EXPECT_NEAR(product[n], 0.0, bound) << "steps " << n - 1 << " and " << n;
    }
    EXPECT_NEAR(end2, 1.0, std::sqrt(2.0) * bound);
}

TEST(ImuTest, BiasWalksWithTheRootOfTime) {
    ImuNoiseConfig noise = kIdeal;
    noise.gyro_walk_rad_s2_sqrt_hz = 2e-4;
    noise.accel_walk_m_s3_sqrt_hz = 3e-3;
    constexpr int kSeeds = 600;
    double gyro2 = 0.0;
    double accel2 = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        // 16 s after the start, one sample.
        const std::int64_t at_ns = kStart_ns + 16 * kNanosecondsPerSecond;
        const auto samples = standing(noise, seed).samples(at_ns - 1, at_ns);
        ASSERT_EQ(samples.size(), 1U);
        gyro2 += samples[0].angular_velocity_rad_s.squaredNorm() / (3.0 * kSeeds);
        accel2 +=
            (samples[0].specific_force_m_s2 - Vector3d(0.0, 0.0, kGravity_m_s2)).squaredNorm() /
            (3.0 * kSeeds);
    }
    // 1800 numbers: five standard errors of sigma are 8 %.
    EXPECT_NEAR(std::sqrt(gyro2) / (2e-4 * 4.0), 1.0, 0.083);
    EXPECT_NEAR(std::sqrt(accel2) / (3e-3 * 4.0), 1.0, 0.083);
    const auto first = standing(noise, 5).samples(kStart_ns - 1, kStart_ns);
    EXPECT_EQ(first.at(0).angular_velocity_rad_s, Vector3d::Zero()) << "bias at the start";
}

TEST(ImuTest, WalkDoesNotDependOnHowSamplesAreAskedFor) {
    const ImuModel imu(std::make_shared<TrolleyMotion>(tour()),
                       turned_mount(),
                       imu_noise_of(ImuKind::mpu6050),
                       kStart_ns,
                       9);
    const std::int64_t from_ns = kStart_ns - 100'000'000;
    const auto all = imu.samples(from_ns, kStart_ns + 700'000'000);
    std::vector<ImuSample> parts;
    // Pieces of odd lengths, asked from the last to the first.
    for (std::int64_t end_ns = kStart_ns + 700'000'000; end_ns > from_ns;) {
        const std::int64_t begin_ns = std::max(from_ns, end_ns - 37'111'113);
        const auto piece = imu.samples(begin_ns, end_ns);
        parts.insert(parts.begin(), piece.begin(), piece.end());
        end_ns = begin_ns;
    }
    ASSERT_EQ(parts.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(parts[i].angular_velocity_rad_s, all[i].angular_velocity_rad_s) << i;
        EXPECT_EQ(parts[i].specific_force_m_s2, all[i].specific_force_m_s2) << i;
    }
}

TEST(ImuTest, ReadingsStayInRangeAndOnTheSteps) {
    ImuNoiseConfig noise = kIdeal;
    noise.accel_range_m_s2 = 9.0;
    noise.accel_step_m_s2 = 0.25;
    noise.accel_density_m_s2_sqrt_hz = 0.1;  // 1.4 m/s2 a sample
    const auto samples = standing(noise, 4).samples(0, 5 * kNanosecondsPerSecond);
    int at_end = 0;
    for (const ImuSample& sample : samples) {
        EXPECT_LE(sample.specific_force_m_s2.cwiseAbs().maxCoeff(), 9.0);
        at_end += sample.specific_force_m_s2.z() == 9.0 ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double counts = sample.specific_force_m_s2[axis] / 0.25;
            EXPECT_EQ(counts, std::round(counts));
        }
    }
    // 9.81 with sigma 1.41 is above 8.875 (which rounds to 9) in 75 % of the samples.
    EXPECT_NEAR(at_end / static_cast<double>(samples.size()), 0.746, 0.07);
}

TEST(ImuTest, PresetsFollowTheirDataSheets) {
    for (const ImuKind kind : {ImuKind::adis16448, ImuKind::mpu6050, ImuKind::bmi055}) {
        const ImuNoiseConfig noise = imu_noise_of(kind);
        const char* name = kImuNames[static_cast<int>(kind)];
        EXPECT_GT(noise.gyro_walk_rad_s2_sqrt_hz, 0.0) << name;
        EXPECT_GT(noise.accel_range_m_s2, kGravity_m_s2) << name << " must be able to stand still";
        EXPECT_LT(noise.accel_step_m_s2, 0.01) << name;
    }
    EXPECT_EQ(imu_noise_of(ImuKind::adis16448).gyro_density_rad_s_sqrt_hz, 1.6968e-4);
    // 0.005 deg/s/sqrt(Hz) and 400 ug/sqrt(Hz).
    EXPECT_NEAR(imu_noise_of(ImuKind::mpu6050).gyro_density_rad_s_sqrt_hz, 8.73e-5, 1e-7);
    EXPECT_NEAR(imu_noise_of(ImuKind::mpu6050).accel_density_m_s2_sqrt_hz, 3.924e-3, 1e-6);
    EXPECT_NEAR(imu_noise_of(ImuKind::bmi055).gyro_density_rad_s_sqrt_hz, 2.443e-4, 1e-7);
    EXPECT_STREQ(kImuNames[static_cast<int>(ImuKind::bmi055)], "bmi055");
}

}  // namespace
}  // namespace surefoot::sim
