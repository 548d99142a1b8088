// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::odometry {
namespace {

const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// A swinging and turning walk whose true motion is known at any time.
struct Walk {
    static Eigen::Vector3d position(double t) {
        return {
            0.4 * std::sin(1.7 * t), 0.3 * t + 0.1 * std::cos(2.3 * t), 0.05 * std::sin(5.0 * t)};
    }
    static Eigen::Vector3d velocity(double t) {
        return {0.68 * std::cos(1.7 * t), 0.3 - 0.23 * std::sin(2.3 * t), 0.25 * std::cos(5.0 * t)};
    }
    static Eigen::Vector3d acceleration(double t) {
        return {-1.156 * std::sin(1.7 * t), -0.529 * std::cos(2.3 * t), -1.25 * std::sin(5.0 * t)};
    }
    /// Rotations about z, then y, then x.
    static Eigen::Quaterniond rotation(double t) {
        return Eigen::AngleAxisd(0.8 * std::sin(0.9 * t), Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(0.3 * std::sin(1.9 * t), Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(0.2 * std::sin(2.9 * t + 0.4), Eigen::Vector3d::UnitX());
    }
    /// From differences of the rotation; the error is 1e-9 rad/s.
    static Eigen::Vector3d turn_rate(double t) {
        constexpr double kStep_s = 1e-4;
        const Eigen::Vector3d d =
            log_so3(rotation(t - kStep_s).conjugate() * rotation(t + kStep_s));
        const Eigen::Vector3d d2 =
            log_so3(rotation(t - 2.0 * kStep_s).conjugate() * rotation(t + 2.0 * kStep_s));
        return (8.0 * d - d2) / (12.0 * kStep_s);
    }
    static ImuSample sample(double t) {
        return {ns_from_seconds(t),
                turn_rate(t),
                rotation(t).conjugate() * (acceleration(t) - kGravity)};
    }
};

std::vector<ImuSample> samples_of(double from_s, double to_s, double rate_hz) {
    std::vector<ImuSample> samples;
    const int n = static_cast<int>(std::lround((to_s - from_s) * rate_hz));
    samples.reserve(static_cast<std::size_t>(n) + 1);
    for (int k = 0; k <= n; ++k) samples.push_back(Walk::sample(from_s + k / rate_hz));
    return samples;
}

/// White noise of a sampled sensor.
void add_noise(std::vector<ImuSample>& samples, const ImuNoise& noise, double rate_hz, Rng& rng) {
    const double gyro = noise.gyro_density_rad_s_sqrt_hz * std::sqrt(rate_hz);
    const double accel = noise.accel_density_m_s2_sqrt_hz * std::sqrt(rate_hz);
    for (ImuSample& s : samples)
        for (int axis = 0; axis < 3; ++axis) {
            s.angular_velocity_rad_s[axis] += gyro * rng.normal();
            s.specific_force_m_s2[axis] += accel * rng.normal();
        }
}

ImuMotion integrated(const std::vector<ImuSample>& samples,
                     double from_s,
                     double to_s,
                     const ImuBias& bias = {}) {
    const auto result =
        preintegrate({}, {}, samples, ns_from_seconds(from_s), ns_from_seconds(to_s), bias);
    EXPECT_EQ(result.problem, ImuProblem::none) << to_string(result.problem);
    return result.motion;
}

/// (rotation, velocity, position) error from `a` to `b`.
Vector9 difference(const ImuMotion& a, const ImuMotion& b) {
    Vector9 d;
    d << log_so3(a.rotation.conjugate() * b.rotation), b.velocity_m_s - a.velocity_m_s,
        b.position_m - a.position_m;
    return d;
}

/// The true motion in the form of ImuMotion.
ImuMotion truth(double from_s, double to_s) {
    ImuMotion m;
    const double dt_s = to_s - from_s;
    const Eigen::Quaterniond R_imu_world = Walk::rotation(from_s).conjugate();
    m.dt_s = dt_s;
    m.rotation = R_imu_world * Walk::rotation(to_s);
    m.velocity_m_s =
        R_imu_world * (Walk::velocity(to_s) - Walk::velocity(from_s) - dt_s * kGravity);
    m.position_m = R_imu_world * (Walk::position(to_s) - Walk::position(from_s) -
                                  dt_s * Walk::velocity(from_s) - 0.5 * dt_s * dt_s * kGravity);
    return m;
}

TEST(ImuPreintegration, FineSamplesGiveTheTrueMotion) {
    const auto samples = samples_of(0.0, 1.0, 10000.0);
    const ImuMotion m = integrated(samples, 0.2, 0.8);
    EXPECT_NEAR(m.dt_s, 0.6, 1e-12);
    const Vector9 error = difference(truth(0.2, 0.8), m);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 2e-7) << error.transpose();  // 20 ppb of 9.81 m/s^2
}

TEST(ImuPreintegration, TheErrorOfTheRuleFallsWithTheSquareOfTheStep) {
    const auto error_at = [](double rate_hz) {
        return difference(truth(0.2, 0.7), integrated(samples_of(0.0, 1.0, rate_hz), 0.2, 0.7))
            .norm();
    };
    EXPECT_NEAR(error_at(200.0) / error_at(400.0), 4.0, 0.3);
    EXPECT_LT(error_at(200.0), 2e-4);
}

/// The frames' stamps lie between the samples.
TEST(ImuPreintegration, EndsAreInterpolated) {
    const auto samples = samples_of(0.0, 1.0, 200.0);
    const Vector9 error = difference(truth(0.2013, 0.2518), integrated(samples, 0.2013, 0.2518));
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 2e-5) << error.transpose();
}

TEST(ImuPreintegration, WithoutALaterSampleTheLastOneHolds) {
    auto samples = samples_of(0.0, 0.25, 200.0);
    const Vector9 error = difference(truth(0.20, 0.2530), integrated(samples, 0.20, 0.2530));
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 3e-4) << error.transpose();
    samples.resize(samples.size() - 8);  // 43 ms without a sample
    EXPECT_EQ(
        preintegrate({}, {}, samples, ns_from_seconds(0.2), ns_from_seconds(0.253), {}).problem,
        ImuProblem::gap);
}

TEST(ImuPreintegration, BiasJacobiansMatchDifferences) {
    const auto samples = samples_of(0.0, 1.0, 200.0);
    const ImuBias at{{0.02, -0.03, 0.01}, {0.1, -0.2, 0.05}};
    const ImuMotion m = integrated(samples, 0.1, 0.6, at);
    constexpr double kStep = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
        ImuBias up = at;
        ImuBias down = at;
        up.gyro_rad_s[axis] += kStep;
        down.gyro_rad_s[axis] -= kStep;
        Vector9 by_gyro =
            difference(integrated(samples, 0.1, 0.6, down), integrated(samples, 0.1, 0.6, up)) /
            (2.0 * kStep);
        EXPECT_LT((by_gyro.head<3>() - m.d_rotation_d_gyro.col(axis)).norm(), 1e-7);
        EXPECT_LT((by_gyro.segment<3>(3) - m.d_velocity_d_gyro.col(axis)).norm(), 1e-6);
        EXPECT_LT((by_gyro.tail<3>() - m.d_position_d_gyro.col(axis)).norm(), 1e-6);
        up = down = at;
        up.accel_m_s2[axis] += kStep;
        down.accel_m_s2[axis] -= kStep;
        const Vector9 by_accel =
            difference(integrated(samples, 0.1, 0.6, down), integrated(samples, 0.1, 0.6, up)) /
            (2.0 * kStep);
        EXPECT_LT(by_accel.head<3>().norm(), 1e-9);
        EXPECT_LT((by_accel.segment<3>(3) - m.d_velocity_d_accel.col(axis)).norm(), 1e-7);
        EXPECT_LT((by_accel.tail<3>() - m.d_position_d_accel.col(axis)).norm(), 1e-7);
    }
}

TEST(ImuPreintegration, AnotherBiasIsRightToFirstOrder) {
    const auto samples = samples_of(0.0, 1.0, 200.0);
    const ImuMotion m = integrated(samples, 0.1, 0.6);
    const auto error_of = [&](double scale) {
        const ImuBias bias{scale * Eigen::Vector3d(0.02, -0.03, 0.01),
                           scale * Eigen::Vector3d(0.1, -0.2, 0.05)};
        ImuMotion corrected;
        corrected.rotation = m.rotation_at(bias);
        corrected.velocity_m_s = m.velocity_at(bias);
        corrected.position_m = m.position_at(bias);
        return difference(integrated(samples, 0.1, 0.6, bias), corrected).norm();
    };
    EXPECT_LT(error_of(1.0), 2e-3);
    EXPECT_NEAR(error_of(1.0) / error_of(0.5), 4.0, 0.3);  // the remaining error is of second order
}

TEST(ImuPreintegration, CovarianceMatchesSampledNoise) {
    constexpr double kRate_hz = 200.0;
    const ImuNoise noise{5e-3, 5e-2, 0.0, 0.0};
    const auto clean = samples_of(0.0, 0.6, kRate_hz);
    const auto run = [&](const std::vector<ImuSample>& samples) {
        return preintegrate({}, noise, samples, ns_from_seconds(0.05), ns_from_seconds(0.55), {})
            .motion;
    };
    const ImuMotion exact = run(clean);
    Matrix9 sampled = Matrix9::Zero();
    constexpr int kRuns = 4000;
    Rng rng(17);
    for (int i = 0; i < kRuns; ++i) {
        auto noisy = clean;
        add_noise(noisy, noise, kRate_hz, rng);
        const Vector9 d = difference(exact, run(noisy));
        sampled += d * d.transpose() / kRuns;
    }
    // In units of the expected sigmas. 4000 runs leave a scatter of 1.6 % per element (2.2 % on the
    // diagonal); the worst of 45 elements may be five times that.
    const Vector9 scale = exact.covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix9 difference_sigmas =
        scale.asDiagonal() * (sampled - exact.covariance) * scale.asDiagonal();
    EXPECT_LT(difference_sigmas.cwiseAbs().maxCoeff(), 0.09) << difference_sigmas;
}

TEST(ImuPreintegration, BadInputIsNamedAndNothingIsMadeOfIt) {
    const auto good = samples_of(0.0, 1.0, 200.0);
    const auto ask = [](const std::vector<ImuSample>& samples, const ImuLimits& limits = {}) {
        const auto result =
            preintegrate(limits, {}, samples, ns_from_seconds(0.4), ns_from_seconds(0.45), {});
        if (result.problem != ImuProblem::none) {
            EXPECT_EQ(result.motion.dt_s, 0.0);
        }
        return result.problem;
    };
    EXPECT_EQ(ask(good), ImuProblem::none);
    EXPECT_EQ(ask({}), ImuProblem::no_samples);
    EXPECT_EQ(ask(samples_of(0.0, 0.2, 200.0)), ImuProblem::no_samples);
    EXPECT_EQ(ask(samples_of(0.6, 0.9, 200.0)), ImuProblem::no_samples);
    EXPECT_EQ(ask(samples_of(0.435, 0.9, 200.0)), ImuProblem::gap);
    auto bad = good;
    bad.erase(bad.begin() + 82, bad.begin() + 89);  // 40 ms without a sample
    EXPECT_EQ(ask(bad), ImuProblem::gap);
    bad = good;
    bad[85].time_ns = bad[84].time_ns;
    EXPECT_EQ(ask(bad), ImuProblem::stamps);
    bad[85].time_ns = bad[84].time_ns - 3'000'000'000LL;
    EXPECT_EQ(ask(bad), ImuProblem::stamps);
    bad = good;
    bad[85].specific_force_m_s2.y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(ask(bad), ImuProblem::not_finite);
    bad = good;
    bad[85].angular_velocity_rad_s.z() = -2.18;  // once: it may be a real reading
    EXPECT_EQ(ask(bad), ImuProblem::none);
    EXPECT_EQ(ask(bad, {.gyro_range_rad_s = 2.18}), ImuProblem::saturated);
    for (std::size_t i = 83; i < 87; ++i) bad[i].angular_velocity_rad_s.z() = -2.18;
    EXPECT_EQ(ask(bad), ImuProblem::saturated);
    bad = good;
    for (std::size_t i = 83; i < 87; ++i) bad[i].specific_force_m_s2.x() = 19.6;
    EXPECT_EQ(ask(bad), ImuProblem::saturated);
    EXPECT_EQ(preintegrate({}, {}, good, 5, 5, {}).problem, ImuProblem::stamps);
    EXPECT_EQ(preintegrate({}, {}, good, 500'000'000, 400'000'000, {}).problem, ImuProblem::stamps);
}

TEST(ImuPreintegration, JacobiansOfRotationVectorsMatchDifferences) {
    for (const double size : {1e-6, 1e-3, 0.7, 2.5}) {
        const Eigen::Vector3d theta = size * Eigen::Vector3d(0.6, -0.64, 0.48);
        const Eigen::Matrix3d J = right_jacobian_so3(theta);
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
            const Eigen::Vector3d by_step =
                log_so3(exp_so3(theta - step).conjugate() * exp_so3(theta + step)) / 2e-6;
            EXPECT_LT((by_step - J.col(axis)).norm(), 1e-9) << size;
        }
        EXPECT_LT((J * inverse_right_jacobian_so3(theta) - Eigen::Matrix3d::Identity()).norm(),
                  1e-12)
            << size;
    }
}

}  // namespace
}  // namespace surefoot::odometry
