// SPDX-License-Identifier: Apache-2.0
// Handling of frames with a repeated or torn image by the pipeline (hazards H1 and H2).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::pipeline {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr std::int64_t kPeriod_ns = 66'000'000;

/// A camera one metre above the ground that points straight down.
camera::StereoRig small_rig() {
    camera::StereoRig rig = camera::test::ideal_rig(kWidth, kHeight, 120.0);
    rig.T_body_left = Pose{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.0, 0.0, 1.0}};
    return rig;
}

/// A frame with known depth and motion: the machine moves `step_m` forward in each frame.
StereoFrame moving_frame(int index, double step_m) {
    StereoFrame frame;
    frame.index = index;
    frame.time_ns = 1'000'000'000 + index * kPeriod_ns;
    DepthImage depth;
    MotionEstimate motion;
    depth.disparity_px = Image<float>(kWidth, kHeight, 12.0F);
    depth.sigma_px = Image<float>(kWidth, kHeight, 0.2F);
    depth.outlier_probability = Image<float>(kWidth, kHeight, 0.0F);
    motion.time_ns = frame.time_ns;
    motion.T_odom_body.translation_m.x() = index * step_m;
    motion.health = Health::ok;
    motion.reason = HealthReason::none;
    frame.known_depth = depth;
    frame.known_motion = motion;
    return frame;
}

TEST(ExposureState, AFrameInGlaringLightIsFollowedButNotFused) {
    Serial serial;
    auto pipeline = Pipeline::make({}, small_rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    const StereoFrame first = moving_frame(0, 0.02);
    pipeline->align({&first, 1});
    EXPECT_GT(pipeline->process(first, Work::full).fusion.points, 0);
    for (int i = 1; i <= 3; ++i) {
        StereoFrame bright = moving_frame(i, 0.02);
        bright.left = bright.right = GreyImage(kWidth, kHeight, i < 3 ? 255 : 128);
        const FrameReport report = pipeline->process(bright, Work::full);
        EXPECT_EQ(report.work == Work::full, i == 3);
        EXPECT_EQ(report.fusion.points > 0, i == 3);
        EXPECT_NEAR(report.motion.T_odom_body.translation_m.x(), i * 0.02, 1e-12);
        EXPECT_EQ(report.camera, i == 1 ? CameraState::ok : CameraState::overexposed)
            << "three good ones release";
    }
    grid::MapSnapshot snapshot;
    ASSERT_TRUE(pipeline->snapshot(1, snapshot).ok());
    EXPECT_EQ(snapshot.camera, CameraState::overexposed);
}

/// Hazards H3 and H20: frames arrive and the motion is known, but no pixel has a valid depth.
TEST(Blind, AFrameThatMeasuresNothingIsNoLookAtTheGround) {
    Serial serial;
    auto pipeline = Pipeline::make({}, small_rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    const StereoFrame first = moving_frame(0, 0.02);
    pipeline->align({&first, 1});
    EXPECT_GT(pipeline->process(first, Work::full).fusion.cells_measured, 0);
    grid::MapSnapshot snapshot;
    ASSERT_TRUE(pipeline->snapshot(1, snapshot).ok());
    const std::uint64_t version = snapshot.version;
    EXPECT_EQ(snapshot.frame_time_ns, first.time_ns);
    int index = 1;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            0.0F,
                            -1.0F}) {
        StereoFrame blind = moving_frame(index++, 0.02);
        blind.known_depth->disparity_px.fill(bad);
        EXPECT_EQ(pipeline->process(blind, Work::full).fusion.cells_measured, 0);
        ASSERT_TRUE(pipeline->snapshot(1, snapshot).ok());
        EXPECT_EQ(snapshot.frame_time_ns, first.time_ns) << "the gate must see it grow old";
        EXPECT_EQ(snapshot.pose_time_ns, blind.time_ns) << "where it is, is known";
        EXPECT_EQ(snapshot.version, version);
    }
    const StereoFrame sees = moving_frame(index, 0.02);
    std::ignore = pipeline->process(sees, Work::full);
    ASSERT_TRUE(pipeline->snapshot(1, snapshot).ok());
    EXPECT_EQ(snapshot.frame_time_ns, sees.time_ns);
}

class Arrival : public ::testing::TestWithParam<bool> {};

TEST_P(Arrival, ABadImageIsNeitherTrackedNorFused) {
    const bool torn = GetParam();
    Serial serial;
    auto pipeline = Pipeline::make({}, small_rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    const StereoFrame first = moving_frame(0, 0.02);
    pipeline->align({&first, 1});
    const FrameReport good = pipeline->process(first, Work::full);
    ASSERT_EQ(good.motion.health, Health::ok);
    grid::MapSnapshot before;
    const Status built = pipeline->snapshot(1, before);
    ASSERT_TRUE(built.ok()) << built.error().message;

    double last_sigma_m = 0.0;
    for (int i = 1; i <= 4; ++i) {
        StereoFrame bad = moving_frame(i, 0.02);
        bad.frame_status.repeated = torn ? 0 : i;
        bad.frame_status.torn = torn;
        const FrameReport report = pipeline->process(bad, Work::full);
        EXPECT_EQ(report.index, i);
        EXPECT_EQ(report.time_ns, bad.time_ns);
        EXPECT_EQ(report.frame_status.torn, torn);
        EXPECT_EQ(report.work, Work::odometry) << "no depth was made";
        EXPECT_EQ(report.motion.health, Health::lost);
        EXPECT_EQ(report.motion.reason,
                  torn ? HealthReason::torn_image : HealthReason::repeated_image);
        EXPECT_TRUE(report.motion.T_odom_body.translation_m ==
                    good.motion.T_odom_body.translation_m);
        EXPECT_EQ(report.fusion.points, 0);
        EXPECT_EQ(report.camera,
                  i < CameraMonitor::kBadFrames ? CameraState::ok
                  : torn                        ? CameraState::corrupt
                                                : CameraState::frozen);
        EXPECT_EQ(report.known_cells, good.known_cells);
        const double sigma_m = std::sqrt(report.motion.relative_covariance(0, 0));
        EXPECT_GT(sigma_m, last_sigma_m) << "what was not seen grows with its time";
        last_sigma_m = sigma_m;
    }
    grid::MapSnapshot after;
    ASSERT_TRUE(pipeline->snapshot(1, after).ok());
    EXPECT_EQ(after.frame_time_ns, before.frame_time_ns) << "the gate must see it grow old";
    EXPECT_EQ(after.pose_time_ns, before.pose_time_ns);
    EXPECT_EQ(after.version, before.version);
    EXPECT_EQ(before.camera, CameraState::ok);
    EXPECT_EQ(after.camera, torn ? CameraState::corrupt : CameraState::frozen);

    const FrameReport next = pipeline->process(moving_frame(5, 0.02), Work::full);
    EXPECT_EQ(next.motion.health, Health::ok);
    EXPECT_NEAR(
        (next.motion.T_odom_body.translation_m - good.motion.T_odom_body.translation_m).norm(),
        0.1,
        1e-9);
}

/// The source marks no frame: the pipeline compares the images itself.
TEST(Watching, AnOldImageIsSeenByThePipeline) {
    Serial serial;
    auto pipeline = Pipeline::make({}, small_rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    Rng rng(5);
    const auto exposed = [&](int index) {
        StereoFrame frame = moving_frame(index, 0.02);
        frame.left = frame.right = GreyImage(kWidth, kHeight);
        for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u)
                frame.left.at(u, v) = frame.right.at(u, v) =
                    static_cast<std::uint8_t>(60 + rng.below(90));
        return frame;
    };
    const StereoFrame first = exposed(0);
    pipeline->align({&first, 1});
    EXPECT_EQ(pipeline->process(first, Work::full).frame_status.repeated, 0);
    for (int i = 1; i <= 2; ++i) {
        StereoFrame frozen = moving_frame(i, 0.02);
        frozen.left = first.left;
        frozen.right = first.right;
        const FrameReport report = pipeline->process(frozen, Work::full);
        EXPECT_EQ(report.frame_status.repeated, i);
        EXPECT_EQ(report.motion.reason, HealthReason::repeated_image);
        EXPECT_EQ(report.fusion.points, 0);
    }
    StereoFrame torn = exposed(3);
    std::copy_n(first.left.row(0), kWidth * kHeight / 2, torn.left.row(0));
    const FrameReport report = pipeline->process(torn, Work::full);
    EXPECT_TRUE(report.frame_status.torn);
    EXPECT_EQ(report.motion.reason, HealthReason::torn_image);
    EXPECT_TRUE(pipeline->process(exposed(4), Work::full).frame_status.is_new_and_whole());
}

INSTANTIATE_TEST_SUITE_P(RepeatedAndTorn, Arrival, ::testing::Bool());

}  // namespace
}  // namespace surefoot::pipeline
