// SPDX-License-Identifier: Apache-2.0
// Odometry with an IMU, from images to poses.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "surefoot/core/time.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kRate_hz = 200.0;
constexpr std::int64_t kFirst_ns = 1'000'000'000;  // same value as in render_frame
constexpr std::int64_t kFrame_ns = 50'000'000;

/// A hand-held curve of the left camera, which begins to move after `still_s`.
struct Curve {
    double still_s = 0.0;
    double shake_rad = 0.0;  ///< at 4 Hz, about x, from the second second on

    [[nodiscard]] Pose at(double t) const {
        const double s = std::max(t - still_s, 0.0);
        const double ease = 1.0 - std::exp(-4.0 * s * s);  // starts without a jerk
        const double shake =
            s < 1.0 ? 0.0 : shake_rad * std::sin(8.0 * std::numbers::pi * (s - 1.0));
        return {exp_so3(ease * Eigen::Vector3d(0.10 * std::sin(2.0 * s) + shake,
                                               0.15 * std::sin(1.3 * s),
                                               0.12 * std::sin(1.7 * s))),
                ease * Eigen::Vector3d(0.2 * std::sin(1.1 * s), 0.08 * std::sin(1.9 * s), 0.1 * s)};
    }
};

/// The room of the other tests with an IMU beside the camera. The world's up is tilted in the
/// camera.
struct Machine {
    camera::StereoRig rig = testing::small_rig();
    Curve curve;
    Pose T_left_imu{exp_so3({0.3, -1.1, 0.5}), {0.06, -0.04, 0.02}};
    Eigen::Vector3d up_world = Eigen::Vector3d(0.1, -0.9, 0.3).normalized();
    ImuBias bias{{0.01, -0.02, 0.015}, {0.05, -0.04, 0.06}};
    std::int64_t read_until_ns = kFirst_ns - kFrame_ns;

    [[nodiscard]] camera::ImuMount mount() const {
        return {rig.body_from_left() * T_left_imu, kRate_hz};
    }

    /// From differences of the curve.
    [[nodiscard]] ImuSample sample(std::int64_t time_ns, Rng& rng) const {
        constexpr double kStep_s = 1e-3;
        const double t = seconds_from_ns(time_ns - kFirst_ns);
        const Pose before = curve.at(t - kStep_s) * T_left_imu;
        const Pose now = curve.at(t) * T_left_imu;
        const Pose after = curve.at(t + kStep_s) * T_left_imu;
        const Eigen::Vector3d acceleration =
            (after.translation_m - 2.0 * now.translation_m + before.translation_m) /
            (kStep_s * kStep_s);
        const auto noise = [&](double sigma) -> Eigen::Vector3d {
            const double x = rng.normal();
            const double y = rng.normal();
            return sigma * Eigen::Vector3d(x, y, rng.normal());
        };
        ImuSample s;
        s.time_ns = time_ns;
        s.angular_velocity_rad_s =
            log_so3(before.rotation.conjugate() * after.rotation) / (2.0 * kStep_s) +
            bias.gyro_rad_s + noise(1.5e-4 * std::sqrt(kRate_hz));
        s.specific_force_m_s2 = now.rotation.conjugate() * (acceleration + 9.80665 * up_world) +
                                bias.accel_m_s2 + noise(2e-3 * std::sqrt(kRate_hz));
        return s;
    }

    [[nodiscard]] StereoFrame frame(int index) {
        const double t = seconds_from_ns(index * kFrame_ns);
        StereoFrame frame = testing::render_rolling_frame(
            rig, [&](double s) { return curve.at(t + s); }, index, 2.0);
        Rng rng(mix_seed(7, static_cast<std::uint64_t>(index)));
        while (read_until_ns + 5'000'000 <= frame.time_ns) {
            read_until_ns += 5'000'000;
            frame.imu.push_back(sample(read_until_ns, rng));
        }
        return frame;
    }
    [[nodiscard]] Pose truth(int index) const {
        return curve.at(seconds_from_ns(index * kFrame_ns));
    }
};

struct Follower {
    camera::StereoRig rig;
    camera::Rectifier rectifier;
    Odometry odometry;

    Follower(const Machine& machine, bool with_imu, const OdometryConfig& config = {})
        : rig(machine.rig),
          rectifier(std::move(camera::Rectifier::make(rig)).value()),
          odometry(config, rectifier, with_imu ? std::optional(machine.mount()) : std::nullopt) {
        odometry.start_at(rig.body_from_left().inverse());  // odom = the first left camera
    }
    [[nodiscard]] double error_m(const MotionEstimate& m, const Pose& truth) const {
        return ((m.T_odom_body * rig.body_from_left()).translation_m - truth.translation_m).norm();
    }
};

void blacken(StereoFrame& frame) {
    frame.left.fill(3);
    frame.right.fill(3);
}

TEST(InertialOdometry, FollowsTheCurveInAnOdomThatLeans) {
    Machine machine;
    Follower run(machine, true);
    Serial serial;
    double worst_m = 0.0;
    for (int i = 0; i < 50; ++i) {
        const auto m = run.odometry.update(machine.frame(i), serial);
        worst_m = std::max(worst_m, run.error_m(m, machine.truth(i)));
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
        }
        EXPECT_GE(m.relative_covariance.diagonal().minCoeff(), 0.0);
    }
    std::printf("worst position error %.2f mm\n", 1e3 * worst_m);
    EXPECT_LT(worst_m, 0.006);
}

/// Shaken at 4 Hz, so that the mean motion since the previous frame says little about the present
/// one. The gyroscope shows the positions of the rows of a rolling shutter.
TEST(InertialOdometry, TheGyroscopeSeesHowARollingShutterMoves) {
    const auto rms_m = [](double readout_s, bool with_imu) {
        Machine machine;
        machine.rig.readout_s = readout_s;
        machine.curve.shake_rad = 0.01;
        Follower run(machine, with_imu);
        Serial serial;
        double sum_m2 = 0.0;
        int counted = 0;
        for (int i = 0; i < 60; ++i) {
            const auto m = run.odometry.update(machine.frame(i), serial);
            if (i < 20) continue;  // the IMU starts within the first second
            sum_m2 += std::pow(run.error_m(m, machine.truth(i)), 2);
            ++counted;
        }
        return std::sqrt(sum_m2 / counted);
    };
    const double global_m = rms_m(0.0, true);
    const double with_imu_m = rms_m(0.03, true);
    const double without_m = rms_m(0.03, false);
    std::printf(
        "rms position error: global shutter %.2f mm, rolling %.2f mm, without IMU %.2f mm\n",
        1e3 * global_m,
        1e3 * with_imu_m,
        1e3 * without_m);
    EXPECT_LT(with_imu_m, 3.0 * global_m);
    EXPECT_GT(without_m, 3.0 * with_imu_m);
}

/// Half a second without images during full motion: the IMU carries the pose.
TEST(InertialOdometry, HalfASecondInTheDarkIsBridged) {
    constexpr int kDark = 50;
    constexpr int kLight = 60;
    double error_mm[2] = {0.0, 0.0};
    for (const bool with_imu : {false, true}) {
        Machine machine;
        Follower run(machine, with_imu);
        Serial serial;
        Matrix6 unseen = Matrix6::Zero();
        for (int i = 0; i < kLight + 5; ++i) {
            StereoFrame frame = machine.frame(i);
            const bool dark = i >= kDark && i < kLight;
            if (dark) blacken(frame);
            const auto m = run.odometry.update(frame, serial);
            EXPECT_EQ(m.health == Health::lost, dark) << i << " " << to_string(m.reason);
            const double error_m = run.error_m(m, machine.truth(i));
            if (dark) {
                unseen += m.relative_covariance;
                error_mm[with_imu ? 1 : 0] = 1e3 * error_m;
            }
            if (dark && with_imu) {
                EXPECT_LT(error_m, 0.05) << i;
                const double variance_m2 = unseen.diagonal().head(3).sum();
                EXPECT_LT(error_m * error_m, 12.0 * variance_m2) << i;
            }
            if (i > kLight) {
                EXPECT_LT(error_m, 0.01) << i;
            }
        }
        const double sigma_m = std::sqrt(unseen.diagonal().head(3).sum());
        if (with_imu) {
            EXPECT_LT(sigma_m, 0.05);
        }
    }
    std::printf("end of the dark: %.1f mm, without IMU %.1f mm\n", error_mm[1], error_mm[0]);
    EXPECT_LT(error_mm[1], 0.5 * error_mm[0]);
}

/// Longer than the IMU may carry the pose: the pose coasts as without an IMU, then the IMU
/// restarts.
TEST(InertialOdometry, LongDarknessCoastsAndTheImuStartsAgain) {
    Machine machine;
    Follower run(machine, true);
    Serial serial;
    Pose before;
    for (int i = 0; i < 90; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i >= 30 && i < 52) blacken(frame);
        const auto m = run.odometry.update(frame, serial);
        EXPECT_TRUE(m.T_odom_body.all_finite());
        if (i > 0) {
            EXPECT_LT((m.T_odom_body.translation_m - before.translation_m).norm(), 0.05) << i;
        }
        if (i == 51) {  // the unseen speed is that of a frame without an IMU
            EXPECT_GT(std::sqrt(m.relative_covariance(0, 0)), 0.1);
        }
        if (i > 54) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
        }
        before = m.T_odom_body;
    }
}

TEST(InertialOdometry, StandingStillIsExact) {
    Machine machine;
    machine.curve.still_s = 100.0;
    Follower run(machine, true);
    Serial serial;
    for (int i = 0; i < 45; ++i) {
        const auto m = run.odometry.update(machine.frame(i), serial);
        if (i > 2) {
            EXPECT_EQ(m.T_previous_body.translation_m, Eigen::Vector3d::Zero()) << i;
        }
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
        }
    }
}

/// Standing reveals the biases, so that the IMU bridges dark images at the first motion.
TEST(InertialOdometry, StandingFirstIsAGoodStart) {
    Machine machine;
    machine.curve.still_s = 2.0;
    Follower run(machine, true);
    Serial serial;
    for (int i = 0; i < 60; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i >= 45 && i < 55) blacken(frame);
        const auto m = run.odometry.update(frame, serial);
        EXPECT_LT(run.error_m(m, machine.truth(i)), i < 45 ? 0.006 : 0.05) << i;
    }
}

TEST(InertialOdometry, AnImuThatContradictsIsNamedAndLeftOut) {
    Machine machine;
    Follower run(machine, true);
    Follower alone(machine, false);
    Serial serial;
    int named = 0;
    for (int i = 0; i < 70; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i >= 30)  // a quarter turn: the housing came loose
            for (ImuSample& s : frame.imu) {
                s.angular_velocity_rad_s = exp_so3({1.57, 0.0, 0.0}) * s.angular_velocity_rad_s;
                s.specific_force_m_s2 = exp_so3({1.57, 0.0, 0.0}) * s.specific_force_m_s2;
            }
        const auto m = run.odometry.update(frame, serial);
        EXPECT_NE(m.health, Health::lost) << i << " " << to_string(m.reason);
        EXPECT_LT(run.error_m(m, machine.truth(i)), 0.01) << i;
        named += m.reason == HealthReason::imu_disagreement ? 1 : 0;
        if (i < 30) {
            EXPECT_EQ(named, 0) << i;
        }
    }
    EXPECT_GE(named, 10);
}

/// The state adapts to a jump of the bias within one or two frames; it is still reported for some
/// time.
TEST(InertialOdometry, AJumpOfTheBiasIsNamedWithinTwoFrames) {
    constexpr int kJump = 32;
    for (const bool turns : {true, false}) {
        Machine machine;
        Follower run(machine, true);
        Serial serial;
        int named = 0;
        for (int i = 0; i < 60; ++i) {
            if (i == kJump && turns) machine.bias.gyro_rad_s.z() += 1.0;
            if (i == kJump && !turns) machine.bias.accel_m_s2.x() += 10.0;
            const auto m = run.odometry.update(machine.frame(i), serial);
            EXPECT_LT(run.error_m(m, machine.truth(i)), 0.01) << i;
            named += m.reason == HealthReason::imu_disagreement ? 1 : 0;
            if (i < kJump) {
                EXPECT_EQ(named, 0) << i;
            }
            if (i == kJump + 2) {
                EXPECT_GT(named, 0) << turns;
            }
        }
        std::printf("%s: named in %d frames\n", turns ? "1 rad/s" : "10 m/s2", named);
        EXPECT_GE(named, 10) << turns;
    }
}

/// Damages the samples of `frames` frames from `kDamaged` on. Of these and the following frames,
/// `named_frames` must have the reason imu_gap; the first damaged frame must not.
constexpr int kDamaged = 30;
void follow_damaged(int frames, int named_frames, const std::function<void(StereoFrame&)>& damage) {
    Machine machine;
    Follower run(machine, true);
    Serial serial;
    for (int i = 0; i < 60; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i >= kDamaged && i < kDamaged + frames) damage(frame);
        const auto m = run.odometry.update(frame, serial);
        if (i == 0) continue;
        EXPECT_EQ(m.health, Health::ok) << i;
        EXPECT_LT(run.error_m(m, machine.truth(i)), 0.006) << i;
        const bool named = i > kDamaged && i <= kDamaged + named_frames;
        EXPECT_STREQ(to_string(m.reason), named ? "imu_gap" : "none") << i;
    }
}

/// The first sample after the gap reveals its end, so that frame also lacks samples.
TEST(InertialOdometry, MissingSamplesAreNamedFromTheSecondFrameOn) {
    constexpr int kForEver = 100;
    for (const int frames : {4, 20, kForEver}) {  // 0.2 s, 1 s
        SCOPED_TRACE(frames);
        follow_damaged(frames, frames, [](StereoFrame& frame) { frame.imu.clear(); });
    }
}

TEST(InertialOdometry, UselessSamplesAreNamedLikeMissingOnes) {
    follow_damaged(6, 6, [](StereoFrame& frame) {
        for (ImuSample& s : frame.imu)
            s.specific_force_m_s2.setConstant(std::numeric_limits<double>::quiet_NaN());
    });
    follow_damaged(6, 5, [](StereoFrame& frame) {
        for (ImuSample& s : frame.imu) s.angular_velocity_rad_s.setConstant(4.36);  // 250 deg/s
    });
}

TEST(InertialOdometry, HalfTheRateIsNoGap) {
    follow_damaged(100, 0, [](StereoFrame& frame) {
        for (std::size_t i = 0; i < frame.imu.size(); ++i)
            frame.imu.erase(frame.imu.begin() + static_cast<std::ptrdiff_t>(i));
    });
}

/// Every stamp occurs twice.
TEST(InertialOdometry, StampsThatRepeatAreNamed) {
    follow_damaged(9, 8, [](StereoFrame& frame) {
        const std::vector<ImuSample> once = std::exchange(frame.imu, {});
        for (const ImuSample& sample : once) frame.imu.insert(frame.imu.end(), 2, sample);
    });
}

/// Without samples nothing carries the pose: its covariance is at once that of a lost camera.
TEST(InertialOdometry, DarknessWithoutSamplesIsUnknownAtOnce) {
    constexpr int kDark = 50;
    const OdometryConfig config;
    for (const int silent : {kDark - 5, kDark - 1, kDark, kDark + 3, 1000}) {
        SCOPED_TRACE(silent);
        Machine machine;
        Follower run(machine, true);
        Serial serial;
        for (int i = 0; i < kDark + 8; ++i) {
            StereoFrame frame = machine.frame(i);
            if (i >= kDark) blacken(frame);
            if (i >= silent) frame.imu.clear();
            const auto m = run.odometry.update(frame, serial);
            if (i < kDark) continue;
            EXPECT_EQ(m.health, Health::lost) << i;
            EXPECT_STREQ(to_string(m.reason), "blur") << "the images are the cause: " << i;
            const double sigma_m = std::sqrt(m.relative_covariance(0, 0));
            const double unseen_m = config.lost_speed_m_s * seconds_from_ns(kFrame_ns);
            EXPECT_EQ(sigma_m > 0.99 * unseen_m, i >= silent) << i << " " << sigma_m;
        }
    }
}

TEST(InertialOdometry, BadSamplesAreLeftOut) {
    Machine machine;
    Follower run(machine, true);
    Serial serial;
    for (int i = 0; i < 60; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i == 30) frame.imu[3].specific_force_m_s2.x() = std::numeric_limits<double>::infinity();
        if (i == 32) frame.imu.clear();
        if (i == 34) std::swap(frame.imu[2], frame.imu[5]);
        if (i == 36) frame.imu[4].time_ns += 3'600'000'000'000;
        const auto m = run.odometry.update(frame, serial);
        EXPECT_TRUE(m.relative_covariance.allFinite());
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
        }
        EXPECT_LT(run.error_m(m, machine.truth(i)), 0.006) << i;
    }
}

/// Repeated or torn frames are not tracked, but their samples count.
TEST(InertialOdometry, SkippedFramesLeaveTheirSamples) {
    double error_m[2] = {0.0, 0.0};
    for (const bool known : {false, true}) {
        Machine machine;
        Follower run(machine, true);
        Serial serial;
        for (int i = 0; i < 49; ++i) {
            StereoFrame frame = machine.frame(i);
            if (i == 40 || i == 41) {
                if (known) run.odometry.skip(frame, {.repeated = 1});
                continue;
            }
            if (i > 43) blacken(frame);  // before another start would be over
            const auto m = run.odometry.update(frame, serial);
            error_m[known ? 1 : 0] = run.error_m(m, machine.truth(i));
        }
    }
    std::printf(
        "after skipping: %.1f mm, samples lost %.1f mm\n", 1e3 * error_m[1], 1e3 * error_m[0]);
    EXPECT_LT(error_m[1], 0.005);
    EXPECT_GT(error_m[0], 2.0 * error_m[1]);
}

/// Without samples, or with the IMU switched off, the mount of an IMU changes no byte.
TEST(InertialOdometry, WithoutSamplesNothingChanges) {
    Machine machine;
    OdometryConfig off;
    off.imu.enabled = false;
    Follower none(machine, false);
    Follower mounted(machine, true);
    Follower disabled(machine, true, off);
    Serial serial;
    for (int i = 0; i < 35; ++i) {
        StereoFrame frame = machine.frame(i);
        if (i == 25) blacken(frame);
        const auto a = none.odometry.update(frame, serial);
        const auto c = disabled.odometry.update(frame, serial);
        frame.imu.clear();
        const auto b = mounted.odometry.update(frame, serial);
        EXPECT_EQ(a.T_odom_body.translation_m, b.T_odom_body.translation_m) << i;
        EXPECT_EQ(a.T_odom_body.translation_m, c.T_odom_body.translation_m) << i;
        EXPECT_EQ(a.relative_covariance, b.relative_covariance) << i;
        EXPECT_EQ(a.relative_covariance, c.relative_covariance) << i;
    }
}

TEST(InertialOdometry, AnyExecutorGivesTheSameBytes) {
    Machine machine;
    Follower a(machine, true);
    Follower b(machine, true);
    Serial serial;
    Backwards backwards;
    for (int i = 0; i < 35; ++i) {
        const StereoFrame frame = machine.frame(i);
        const auto ma = a.odometry.update(frame, serial);
        const auto mb = b.odometry.update(frame, backwards);
        EXPECT_EQ(ma.T_odom_body.translation_m, mb.T_odom_body.translation_m) << i;
        EXPECT_EQ(ma.T_odom_body.rotation.coeffs(), mb.T_odom_body.rotation.coeffs()) << i;
        EXPECT_EQ(ma.relative_covariance, mb.relative_covariance) << i;
    }
}

}  // namespace
}  // namespace surefoot::odometry
