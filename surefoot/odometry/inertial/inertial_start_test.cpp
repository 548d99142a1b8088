// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kRate_hz = 200.0;
constexpr double kFrame_s = 0.05;
constexpr int kFrames = 21;
constexpr double kGravity_m_s2 = 9.81;

struct Seen {
    std::vector<SeenMotion> frames;
    InertialState truth;  ///< at the last frame
};

/// A second of motion (or of standing) in a tilted odom, observed with `noise_m`, `noise_rad`.
Seen second_of(bool moving, double noise_m, double noise_rad) {
    Rng rng(11);
    const auto noise = [&](double sigma) -> Eigen::Vector3d {
        const double x = rng.normal();
        const double y = rng.normal();
        return sigma * Eigen::Vector3d(x, y, rng.normal());
    };
    const double on = moving ? 1.0 : 0.0;
    InertialModel model;
    model.gravity_m_s2 = kGravity_m_s2;
    InertialState state;
    state.R_odom_level = exp_so3({0.4, -0.3, 0.0});
    state.velocity_m_s = on * Eigen::Vector3d(0.3, -0.2, 0.1);
    const Eigen::Vector3d bias(0.02, -0.05, 0.08);
    std::vector<ImuSample> clean;
    clean.reserve(300);
    for (int k = 0; k < 300; ++k) {
        const double t = k / kRate_hz;
        clean.push_back(
            {ns_from_seconds(t),
             on * Eigen::Vector3d(0.5 * std::sin(3.0 * t), 0.4 * std::cos(2.0 * t), 0.3),
             kGravity_m_s2 * state.up_odom() +
                 on * Eigen::Vector3d(std::cos(4.0 * t), std::sin(2.7 * t), 0.5)});
    }
    auto read = clean;
    for (ImuSample& s : read) {
        s.angular_velocity_rad_s += bias;
        s.angular_velocity_rad_s += noise(1.5e-4 * std::sqrt(kRate_hz));
        s.specific_force_m_s2 += noise(2e-3 * std::sqrt(kRate_hz));
    }
    Seen seen;
    seen.frames.reserve(kFrames);
    for (int i = 0; i < kFrames; ++i) {
        SeenMotion frame;
        if (i > 0) {
            const std::int64_t from = ns_from_seconds((i - 1) * kFrame_s);
            const std::int64_t to = ns_from_seconds(i * kFrame_s);
            frame.motion = preintegrate({}, {}, read, from, to, {}).motion;
            const auto exact = preintegrate({}, {}, clean, from, to, {}).motion;
            state = predict(model, {state, Matrix17::Identity()}, exact).state;
        }
        Vector6 error;
        error << noise(noise_m), noise(noise_rad);
        frame.T_odom_imu = perturbed(state.T_odom_imu, error);
        seen.frames.push_back(frame);
    }
    seen.truth = state;
    seen.truth.bias.gyro_rad_s = bias;
    return seen;
}

void expect_near(const InertialStart& start, const InertialState& truth, double tilt_rad) {
    const double lean = std::atan2(start.state.up_odom().cross(truth.up_odom()).norm(),
                                   start.state.up_odom().dot(truth.up_odom()));
    EXPECT_LT(lean, tilt_rad);
    EXPECT_LT((start.state.velocity_m_s - truth.velocity_m_s).norm(), 0.02);
    EXPECT_LT((start.state.bias.gyro_rad_s - truth.bias.gyro_rad_s).norm(), 2e-3);
    EXPECT_NEAR(start.gravity_m_s2, kGravity_m_s2, 0.05);
}

TEST(InertialStart, FindsGravityVelocityAndBiasWhileMoving) {
    const Seen seen = second_of(true, 3e-4, 3e-4);
    const auto start = start_inertial(seen.frames);
    ASSERT_TRUE(start);
    expect_near(*start, seen.truth, 2e-3);
    EXPECT_LT(start->residual_m, 1e-3);
    EXPECT_LT(start->residual_rad, 2e-3);
}

TEST(InertialStart, FindsThemWhileStanding) {
    const Seen seen = second_of(false, 1e-4, 1e-4);
    const auto start = start_inertial(seen.frames);
    ASSERT_TRUE(start);
    expect_near(*start, seen.truth, 2e-3);
    EXPECT_LT(start->state.velocity_m_s.norm(), 3e-3);
}

TEST(InertialStart, AnImuThatIsMountedOtherwiseDoesNotFit) {
    Seen seen = second_of(true, 3e-4, 3e-4);
    const Pose T_quarter{exp_so3({0.0, 1.5708, 0.0}), Eigen::Vector3d::Zero()};
    for (SeenMotion& frame : seen.frames) frame.T_odom_imu = frame.T_odom_imu * T_quarter;
    const auto start = start_inertial(seen.frames);
    ASSERT_TRUE(start);
    EXPECT_GT(start->residual_rad, 8e-3);
}

TEST(InertialStart, TooFewFramesOrNoForceAreNoStart) {
    Seen seen = second_of(true, 0.0, 0.0);
    EXPECT_FALSE(start_inertial(std::span(seen.frames).first(3)));
    EXPECT_TRUE(start_inertial(std::span(seen.frames).first(4)));
    for (SeenMotion& frame : seen.frames) frame = {};
    for (SeenMotion& frame : seen.frames) frame.motion.dt_s = kFrame_s;
    EXPECT_FALSE(start_inertial(seen.frames));
}

}  // namespace
}  // namespace surefoot::odometry
