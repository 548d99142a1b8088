// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/odometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/core/time.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

using testing::render_frame;

constexpr double kNoise_grey = 2.0;

/// A hand-held curve: 0.3 m/s and up to 0.4 rad/s at 20 Hz.
Pose truth_at(double index) {
    const double t = 0.05 * index;
    return {exp_so3({0.10 * std::sin(2.0 * t), 0.15 * std::sin(1.3 * t), 0.12 * std::sin(1.7 * t)}),
            {0.2 * std::sin(1.1 * t), 0.08 * std::sin(1.9 * t), 0.15 * t}};
}

struct Follower {
    camera::StereoRig rig;
    camera::Rectifier rectifier;
    Odometry odometry;

    explicit Follower(const camera::StereoRig& r, const OdometryConfig& config = {})
        : rig(r),
          rectifier(std::move(camera::Rectifier::make(r)).value()),
          odometry(config, rectifier) {
        odometry.start_at(rig.body_from_left().inverse());  // odom = the first left camera
    }
    Pose left_camera(const MotionEstimate& m) const { return m.T_odom_body * rig.body_from_left(); }
};

void expect_valid(const MotionEstimate& m) {
    EXPECT_TRUE(m.T_odom_body.all_finite());
    EXPECT_TRUE(m.relative_covariance.allFinite());
    EXPECT_GE(m.relative_covariance.diagonal().minCoeff(), 0.0);
}

/// A person in front of the left `share` of the view: a board 0.9 m ahead that moves with the
/// camera.
void step_in_front(const camera::StereoRig& rig, double share, StereoFrame& frame) {
    constexpr double kAway_m = 0.9;
    const auto paint = [&](const camera::Camera& camera,
                           const Pose& T_left_camera,
                           GreyImage& image) {
        const std::vector<Eigen::Vector3d>& rays = testing::rays_of(camera);
        for (int v = 0; v < camera.height; ++v) {
            for (int u = 0; u < camera.width; ++u) {
                const Eigen::Vector3d along =
                    T_left_camera.rotation * rays[static_cast<std::size_t>(v * camera.width + u)];
                const Eigen::Vector3d p =
                    T_left_camera.translation_m +
                    (kAway_m - T_left_camera.translation_m.z()) / along.z() * along;
                const auto seen = camera::project(rig.left.model, p);
                if (!seen || seen->x() > share * rig.left.width) continue;
                image.at(u, v) =
                    static_cast<std::uint8_t>(testing::texture_grey(1, 3.0 * p.y(), 3.0 * p.x()));
            }
        }
    };
    paint(rig.left, Pose{}, frame.left);
    paint(*rig.right, rig.T_left_right, frame.right);
}

TEST(Odometry, SomebodyWhoStepsInIsNamedAndNotFollowed) {
    for (const double share : {0.5, 0.7}) {
        Follower run(testing::small_rig());
        Serial serial;
        double worst_m = 0.0;
        for (int i = 0; i < 20; ++i) {
            const Pose truth = truth_at(3 * i);  // faster than 3 px a frame on the board
            StereoFrame frame = render_frame(run.rig, truth, i, kNoise_grey);
            if (i >= 10) step_in_front(run.rig, share, frame);
            const auto m = run.odometry.update(frame, serial);
            expect_valid(m);
            if (i == 12) {  // two frames later; in its first frame the board is unknown
                EXPECT_EQ(m.health, Health::degraded) << share;
                EXPECT_STREQ(to_string(m.reason), "moving_scene") << share;
            }
            worst_m =
                std::max(worst_m, (run.left_camera(m).translation_m - truth.translation_m).norm());
        }
        std::printf("worst position error %.2f mm\n", 1e3 * worst_m);
        EXPECT_LT(worst_m, 0.020) << share;  // the camera moved 0.2 m meanwhile
    }
}

TEST(Odometry, ExchangedEyesAreLostAndADarkRightEyeIsDegraded) {
    for (const bool swapped : {true, false}) {
        Follower run(testing::small_rig());
        Serial serial;
        std::int64_t last_wrong_ns = 0;
        for (int i = 0; i < 32; ++i) {
            StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
            const bool wrong = i >= 10 && i < 14;
            if (wrong) last_wrong_ns = frame.time_ns;
            if (wrong && swapped) std::swap(frame.left, frame.right);
            if (wrong && !swapped) frame.right.fill(3);
            const auto m = run.odometry.update(frame, serial);
            expect_valid(m);
            if (wrong) {
                EXPECT_EQ(m.health, swapped ? Health::lost : Health::degraded) << i;
                EXPECT_STREQ(to_string(m.reason), swapped ? "cameras_swapped" : "poor_geometry")
                    << i;
            }
            // The health stays DEGRADED for one frame after swapped cameras, and for half a second
            // after missing depth.
            const bool unsure =
                swapped ? i == 14 : seconds_from_ns(frame.time_ns - last_wrong_ns) <= 0.5;
            if (i >= 14) {
                EXPECT_EQ(m.health, unsure ? Health::degraded : Health::ok) << swapped << i;
                EXPECT_STREQ(to_string(m.reason), unsure ? "recovered" : "none") << swapped << i;
            }
            if (!swapped || i > 14) {
                EXPECT_LT((run.left_camera(m).translation_m - truth_at(i).translation_m).norm(),
                          0.010)
                    << i;
            }
        }
    }
}

/// Images of swapped cameras also contain points that seem to agree, but their landmarks are wrong.
TEST(Odometry, EyesExchangedFromTheStartAreLostUntilTheyAreInOrder) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 20; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i < 15) std::swap(frame.left, frame.right);
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        // The frame that seeds landmarks has no earlier landmarks to compare with; the next frame
        // has.
        EXPECT_EQ(m.health, i <= 15 ? Health::lost : i == 16 ? Health::degraded : Health::ok) << i;
        if (i == 15) continue;
        EXPECT_STREQ(to_string(m.reason),
                     i < 15    ? "cameras_swapped"
                     : i == 16 ? "recovered"
                               : "none")
            << i;
    }
}

/// Nothing else checks these frames: the odometry itself must detect a repeated image.
TEST(Odometry, AnImageThatWasThereBeforeIsNoMachineThatStands) {
    Follower run(testing::small_rig());
    Serial serial;
    const auto shown = [&](int i) { return render_frame(run.rig, truth_at(i), i, kNoise_grey); };
    for (int i = 0; i < 20; ++i) {
        StereoFrame frame = shown(i);
        const bool old = i == 10 || i == 11;
        if (old) {
            frame.left = shown(9).left;
            frame.right = shown(9).right;
        }
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        if (i == 0) continue;
        EXPECT_EQ(m.health, old ? Health::lost : i == 12 ? Health::degraded : Health::ok) << i;
        EXPECT_STREQ(to_string(m.reason),
                     old       ? "repeated_image"
                     : i == 12 ? "recovered"
                               : "none")
            << i;
        if (old) {
            EXPECT_GT(m.relative_covariance(0, 0), 0.0) << "the camera may have moved unseen";
            EXPECT_EQ(m.inliers, 0);
        }
    }
}

/// The rows reveal only the first torn image; the later ones lack data that never arrived. All of
/// them are DEGRADED or LOST, and so are the frames of the following second.
TEST(Odometry, AfterATornImageTheNextOnesAreSuspect) {
    Follower run(testing::small_rig());
    Serial serial;
    const auto shown = [&](int i) { return render_frame(run.rig, truth_at(i), i, kNoise_grey); };
    std::int64_t torn_ns = 0;
    for (int i = 0; i < 50; ++i) {
        StereoFrame frame = shown(i);
        const bool torn = i >= 10 && i < 13;
        if (torn) {
            const StereoFrame before = shown(i - 1);
            for (int v = frame.left.height() / 2; v < frame.left.height(); ++v) {
                std::copy_n(before.left.row(v), frame.left.width(), frame.left.row(v));
                std::copy_n(before.right.row(v), frame.right.width(), frame.right.row(v));
            }
        }
        if (i == 10) torn_ns = frame.time_ns;
        const auto m = run.odometry.update(frame, serial);
        if (i == 10) {
            EXPECT_EQ(m.health, Health::lost);
            EXPECT_STREQ(to_string(m.reason), "torn_image");
        }
        const bool suspect = i >= 10 && seconds_from_ns(frame.time_ns - torn_ns) <= 1.0;
        EXPECT_EQ(m.health == Health::ok, i > 0 && !suspect) << i << to_string(m.reason);
    }
}

TEST(Odometry, FollowsAHandHeldCurve) {
    Follower run(testing::small_rig());
    Serial serial;
    double worst_m = 0.0;
    Pose previous;
    for (int i = 0; i < 40; ++i) {
        const auto m =
            run.odometry.update(render_frame(run.rig, truth_at(i), i, kNoise_grey), serial);
        expect_valid(m);
        const Pose T = run.left_camera(m);
        worst_m = std::max(worst_m, (T.translation_m - truth_at(i).translation_m).norm());
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << "frame " << i << " " << to_string(m.reason);
            EXPECT_LT(difference(previous * m.T_previous_body, m.T_odom_body).norm(), 1e-9);
        }
        previous = m.T_odom_body;
    }
    std::printf("worst position error %.2f mm\n", 1e3 * worst_m);
    EXPECT_LT(worst_m, 0.010);  // 0.3 m path, walls up to 3 m away, 352 px wide images
}

/// The same curve, but the camera starts from rest within half a second.
Pose from_rest(double index) {
    const double t = 0.05 * std::max(index, 0.0);
    return truth_at(20.0 * (t - 0.2 * std::tanh(t / 0.2)));
}

/// Rms position error along the path of a camera with 30 ms readout.
double rolling_error_m(const camera::StereoRig& camera_rig, const camera::StereoRig& known_rig) {
    Follower run(known_rig);
    Serial serial;
    double sum_m2 = 0.0;
    constexpr int kFrames = 40;
    for (int i = 0; i < kFrames; ++i) {
        const auto frame = testing::render_rolling_frame(
            camera_rig, [&](double s) { return from_rest(i + 20.0 * s); }, i, kNoise_grey);
        const auto m = run.odometry.update(frame, serial);
        sum_m2 += (run.left_camera(m).translation_m - from_rest(i).translation_m).squaredNorm();
    }
    return std::sqrt(sum_m2 / kFrames);
}

TEST(Odometry, RowsOfARollingShutterAreBroughtToTheStamp) {
    const camera::StereoRig global = testing::small_rig();
    camera::StereoRig rolling = global;
    rolling.readout_s = 0.03;
    const double global_m = rolling_error_m(global, global);
    const double known_m = rolling_error_m(rolling, rolling);
    const double unknown_m = rolling_error_m(rolling, global);
    std::printf(
        "rms position error: global shutter %.2f mm, rolling %.2f mm, rolling with unknown readout "
        "time "
        "%.2f mm\n",
        1e3 * global_m,
        1e3 * known_m,
        1e3 * unknown_m);
    EXPECT_LT(known_m, 2.0 * global_m);
    EXPECT_GT(unknown_m, 3.0 * known_m);
}

TEST(Odometry, FollowsDepthImages) {
    Follower run(testing::small_depth_rig());
    Serial serial;
    double worst_m = 0.0;
    for (int i = 0; i < 20; ++i) {
        const auto m =
            run.odometry.update(render_frame(run.rig, truth_at(i), i, kNoise_grey), serial);
        worst_m = std::max(worst_m,
                           (run.left_camera(m).translation_m - truth_at(i).translation_m).norm());
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << "frame " << i << " " << to_string(m.reason);
        }
    }
    std::printf("worst position error %.2f mm\n", 1e3 * worst_m);
    EXPECT_LT(worst_m, 0.010);
}

TEST(Odometry, StandingStillIsExact) {
    Follower run(testing::small_rig());
    Serial serial;
    Pose start;
    double variance = 0.0;
    for (int i = 0; i < 20; ++i) {
        const auto m = run.odometry.update(render_frame(run.rig, truth_at(0), i, 4.0), serial);
        if (i == 0) start = m.T_odom_body;
        variance += m.relative_covariance(0, 0);
        // The first frame after the start may move within its noise; then nothing moves.
        const double moved_m = (m.T_odom_body.translation_m - start.translation_m).norm();
        EXPECT_LT(moved_m, 0.5e-3) << "frame " << i;
        if (i > 2) {
            EXPECT_EQ(m.T_previous_body.translation_m, Eigen::Vector3d::Zero()) << i;
        }
    }
    EXPECT_LT(std::sqrt(variance), 3e-3);  // the error of a held pose does not grow
}

TEST(Odometry, AnOnsetOfThreeMillimetresIsSeenAtOnce) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 12; ++i) {
        Pose T = truth_at(0);
        if (i >= 10) T.translation_m.z() += 0.003;
        const auto m = run.odometry.update(render_frame(run.rig, T, i, kNoise_grey), serial);
        if (i > 2 && i < 10) {
            EXPECT_EQ(m.T_previous_body.translation_m, Eigen::Vector3d::Zero()) << i;
        }
        if (i == 10) {
            EXPECT_NEAR(m.T_previous_body.translation_m.norm(), 0.003, 0.0015);
        }
    }
}

TEST(Odometry, BlackFramesAreLostForBlurAndBridged) {
    Follower run(testing::small_rig());
    Serial serial;
    double unseen_sigma_m = 0.0;
    for (int i = 0; i < 24; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        const bool black = i >= 10 && i < 14;
        if (black) {
            frame.left.fill(3);
            frame.right.fill(3);
        }
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        if (black) {
            EXPECT_EQ(m.health, Health::lost) << i;
            EXPECT_STREQ(to_string(m.reason), "blur") << i;
            unseen_sigma_m = std::sqrt(m.relative_covariance(0, 0));
            EXPECT_GT(unseen_sigma_m, 0.01) << i;
            EXPECT_LT(m.T_previous_body.translation_m.norm(), 0.05) << "jump in frame " << i;
        }
        if (i == 14) {
            EXPECT_EQ(m.health, Health::degraded) << "a recovered pose must be degraded";
            EXPECT_STREQ(to_string(m.reason), "recovered");
        }
        if (i > 14) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
            EXPECT_LT((run.left_camera(m).translation_m - truth_at(i).translation_m).norm(), 0.010)
                << i;
        }
    }
}

TEST(Odometry, LongLossStartsANewMapWithoutAJump) {
    Follower run(testing::small_rig());
    Serial serial;
    Pose before;
    int recovered = -1;
    for (int i = 0; i < 40; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i >= 8 && i < 28) frame.left.fill(0);
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        if (i > 0) {
            EXPECT_LT((m.T_odom_body.translation_m - before.translation_m).norm(), 0.04)
                << "frame " << i;
        }
        before = m.T_odom_body;
        if (i >= 28 && recovered < 0 && m.health == Health::ok) recovered = i;
    }
    EXPECT_GE(recovered, 29);
    EXPECT_LE(recovered, 31);
}

/// Motion that the joints report from one frame of the curve to the next.
MachineMotion known_motion(const Follower& run, int index, double sigma_m, double sigma_rad) {
    const Pose T_left_body = run.rig.body_from_left().inverse();
    MachineMotion motion;
    motion.T_previous_body =
        (truth_at(index - 1) * T_left_body).inverse() * (truth_at(index) * T_left_body);
    motion.covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
    motion.covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
    return motion;
}

TEST(Odometry, TheMachineCarriesThePoseInTheDark) {
    Follower run(testing::small_rig());
    Serial serial;
    Matrix6 dark = Matrix6::Zero();
    for (int i = 0; i < 40; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        frame.machine_motion = known_motion(run, i, 2e-3, 1e-3);
        const bool black = i >= 8 && i < 28;  // one second, in full motion
        if (black) {
            frame.left.fill(0);
            frame.right.fill(0);
        }
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        if (i == 0) continue;
        // The first image after the dark second gives new landmarks.
        EXPECT_EQ(m.health == Health::lost, black || i == 28) << i << " " << to_string(m.reason);
        const double error_m =
            (run.left_camera(m).translation_m - truth_at(i).translation_m).norm();
        EXPECT_LT(error_m, 0.01) << i;
        if (black) dark = compose_covariance(dark, m.T_previous_body, m.relative_covariance);
    }
    // Twenty motions with a sigma of 2 mm each; the lever arm adds the effect of the rotations.
    EXPECT_GT(std::sqrt(dark(0, 0)), 2e-3 * std::sqrt(19.0));
    EXPECT_LT(std::sqrt(dark(0, 0)), 0.02);
}

TEST(Odometry, AMachineThatSlipsIsNamedAndLeftOut) {
    Follower run(testing::small_rig());
    Serial serial;
    double worst_m = 0.0;
    for (int i = 0; i < 20; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        frame.machine_motion = known_motion(run, i, 5e-4, 1e-3);
        if (i >= 10) frame.machine_motion->T_previous_body.translation_m *= 0.3;
        const auto m = run.odometry.update(frame, serial);
        worst_m = std::max(worst_m,
                           (run.left_camera(m).translation_m - truth_at(i).translation_m).norm());
        const bool named = m.reason == HealthReason::machine_disagreement;
        EXPECT_EQ(named, i > 12) << i;  // after three contradictions in a row
        if (named) {
            EXPECT_EQ(m.health, Health::degraded);
        }
    }
    EXPECT_LT(worst_m, 0.010);
}

TEST(Odometry, WhatNoMachineCanDoIsNotBelieved) {
    OdometryConfig config;
    config.machine_speed_m_s = 0.5;
    config.machine_turn_deg_s = 60.0;
    Follower run(testing::small_rig(), config);
    Serial serial;
    Pose before;
    for (int i = 0; i < 20; ++i) {
        Pose T = truth_at(i);
        if (i >= 10) T.translation_m.x() -= 0.06;  // within one frame; the real step is 25 mm
        const auto m = run.odometry.update(render_frame(run.rig, T, i, kNoise_grey), serial);
        if (i == 10) {
            EXPECT_EQ(m.health, Health::lost);
            EXPECT_EQ(m.reason, HealthReason::beyond_machine);
            EXPECT_LT((before.inverse() * m.T_odom_body).translation_m.norm(), 0.03);
        } else if (i > 0 && (i < 10 || i > 14)) {  // the camera can have moved that far by then
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
            EXPECT_LT((run.left_camera(m).translation_m - T.translation_m).norm(), 0.01) << i;
        }
        before = m.T_odom_body;
    }
}

TEST(Odometry, BlackFromTheStartWaitsForAnImage) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 8; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(0), i, kNoise_grey);
        if (i < 3) frame.left.fill(0);
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        if (i < 4) {
            EXPECT_EQ(m.health, Health::lost) << i;
        }
        if (i > 4) {
            EXPECT_EQ(m.health, Health::ok) << i << " " << to_string(m.reason);
        }
    }
}

TEST(Odometry, WrongSizeAndMissingRightImageAreNoCrash) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 6; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i == 2) frame.left = GreyImage(10, 10);
        if (i == 4) frame.right = GreyImage();
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        EXPECT_EQ(m.health == Health::lost, i == 2) << "frame " << i;
    }
}

TEST(Odometry, TimeGapIsNamed) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 4; ++i) {
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i == 3) frame.time_ns += 5'000'000'000LL;
        const auto m = run.odometry.update(frame, serial);
        if (i == 3) {
            EXPECT_STREQ(to_string(m.reason), "time_gap");
        }
    }
}

TEST(Odometry, StampsThatDoNotGrowAndDroppedFramesAreNamed) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 14; ++i) {
        if (i > 7 && i < 11) continue;  // three dropped
        StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i == 4) frame.time_ns -= 50'000'000;
        const auto m = run.odometry.update(frame, serial);
        expect_valid(m);
        const bool named = m.health == Health::degraded && m.reason == HealthReason::time_gap;
        if (i > 0) {
            EXPECT_EQ(named, i == 4 || i == 11) << i << " " << to_string(m.reason);
        }
        EXPECT_LT((run.left_camera(m).translation_m - truth_at(i).translation_m).norm(), 0.010)
            << i;
    }
}

/// After a skipped frame, points are found again instead of tracked.
TEST(Odometry, AfterSkippedFramesThePoseIsRecovered) {
    Follower run(testing::small_rig());
    Serial serial;
    for (int i = 0; i < 8; ++i) {
        const StereoFrame frame = render_frame(run.rig, truth_at(i), i, kNoise_grey);
        if (i == 5) {
            run.odometry.skip(frame, {.repeated = 1});
            continue;
        }
        const auto m = run.odometry.update(frame, serial);
        if (i > 0) {
            EXPECT_STREQ(to_string(m.reason), i == 6 ? "recovered" : "none") << i;
        }
    }
}

TEST(Odometry, AnyExecutorGivesTheSameBytes) {
    Follower a(testing::small_rig());
    Follower b(testing::small_rig());
    Serial serial;
    Backwards backwards;
    for (int i = 0; i < 12; ++i) {
        const StereoFrame frame = render_frame(a.rig, truth_at(i), i, kNoise_grey);
        const auto ma = a.odometry.update(frame, serial);
        const auto mb = b.odometry.update(frame, backwards);
        EXPECT_EQ(ma.T_odom_body.translation_m, mb.T_odom_body.translation_m) << i;
        EXPECT_EQ(ma.T_odom_body.rotation.coeffs(), mb.T_odom_body.rotation.coeffs()) << i;
        EXPECT_EQ(ma.relative_covariance, mb.relative_covariance) << i;
        EXPECT_EQ(ma.inliers, mb.inliers) << i;
    }
}

}  // namespace
}  // namespace surefoot::odometry
