// SPDX-License-Identifier: Apache-2.0
#include "service/live/live_session.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::app {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr int kGoodFrames = 14;
constexpr int kFrames = 18;
constexpr std::int64_t kPeriod_ns = 66'000'000;

GreyImage noise(std::uint64_t seed) {
    Rng rng(seed);
    GreyImage image(kWidth, kHeight);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(100 + rng.below(100));
    return image;
}

/// The camera of a machine that stands on level ground. Depth is given, so the images (noise) only
/// decide whether a frame is new and whole. After `kGoodFrames` frames the images repeat or, with
/// `tears`, the upper half of the left image comes from the last good frame.
class FailingCamera final : public camera::FrameSource {
  public:
    explicit FailingCamera(bool tears, bool steady_stamps = false) : tears_(tears) {
        rig_ = camera::test::ideal_rig(kWidth, kHeight, 120.0);
        rig_.T_body_left =
            Pose{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.0, 0.0, 1.0}};  // straight down
        info_.T_odom_first_body = Pose{};
        info_.steady_stamps = steady_stamps;
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (index_ == kFrames) return std::optional<StereoFrame>();
        StereoFrame frame;
        frame.index = index_;
        frame.time_ns = 1'000'000'000 + index_ * kPeriod_ns;
        const bool bad = index_ >= kGoodFrames;
        const auto shown = static_cast<std::uint64_t>(bad && !tears_ ? kGoodFrames - 1 : index_);
        frame.left = noise(2 * shown + 1);
        frame.right = noise(2 * shown + 2);
        if (bad && tears_) {
            const GreyImage old = noise(2 * kGoodFrames - 1);
            std::copy_n(old.data(), old.size() / 2, frame.left.data());
        }
        DepthImage depth;
        depth.disparity_px = Image<float>(kWidth, kHeight, 12.0F);
        depth.sigma_px = Image<float>(kWidth, kHeight, 0.2F);
        depth.outlier_probability = Image<float>(kWidth, kHeight, 0.0F);
        frame.known_depth = depth;
        MotionEstimate motion;
        motion.time_ns = frame.time_ns;
        motion.health = Health::ok;
        frame.known_motion = motion;
        ++index_;
        return std::optional<StereoFrame>(std::move(frame));
    }

    [[nodiscard]] std::int64_t last_stamp_ns() const {
        return 1'000'000'000 + (index_ - 1) * kPeriod_ns;
    }

  private:
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    bool tears_;
    int index_ = 0;
};

class LiveSessionTest : public ::testing::TestWithParam<bool> {};

TEST_P(LiveSessionTest, TheGateHearsOfRepeatedAndTornImages) {
    const bool tears = GetParam();
    const auto path = std::filesystem::temp_directory_path() /
                      ("surefoot_live_session_" + std::to_string(::getpid()) + (tears ? "t" : "r"));
    FailingCamera camera(tears);
    Serial serial;
    auto pipeline = pipeline::Pipeline::make({}, camera.rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    auto writer = gate_process::SnapshotWriter::create({path.string(), {}});
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    std::int64_t now_ns = 0;
    LiveSession session(*pipeline, camera, *writer, 1, [&now_ns] { return now_ns += 1000; });
    const auto end = session.run(0.0, [] { return true; });
    std::filesystem::remove(path);
    ASSERT_TRUE(end.ok()) << end.error().message;
    EXPECT_EQ(*end, LiveSession::End::source_ended);
    EXPECT_EQ(session.published(), static_cast<std::uint64_t>(kFrames));
    const grid::MapSnapshot& last = session.last();
    EXPECT_EQ(last.camera, tears ? CameraState::corrupt : CameraState::frozen);
    EXPECT_EQ(last.frame_time_ns, kGoodFrames * 1000) << "the last image that was new and whole";
    EXPECT_EQ(last.pose_time_ns, kGoodFrames * 1000);
}

TEST(LiveSessionAges, ThoseOfALiveCameraCountFromItsStamps) {
    constexpr std::int64_t kLastGood_ns = 1'000'000'000 + (kGoodFrames - 1) * kPeriod_ns;
    for (const std::int64_t latency_ns : {std::int64_t{180'000'000}, std::int64_t{-5'000'000}}) {
        const auto path = std::filesystem::temp_directory_path() /
                          ("surefoot_live_ages_" + std::to_string(::getpid()));
        FailingCamera camera(false, true);
        Serial serial;
        auto pipeline = pipeline::Pipeline::make({}, camera.rig(), serial);
        ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
        auto writer = gate_process::SnapshotWriter::create({path.string(), {}});
        ASSERT_TRUE(writer.ok()) << writer.error().message;
        LiveSession session(
            *pipeline, camera, *writer, 1, [&] { return camera.last_stamp_ns() + latency_ns; });
        const auto end = session.run(1.0, [] { return true; });
        std::filesystem::remove(path);
        ASSERT_TRUE(end.ok()) << end.error().message;
        EXPECT_EQ(session.last().frame_time_ns, kLastGood_ns)
            << "one from the future as well: the gate refuses it";
    }
}

/// Playback after a pause keeps its speed; it does not catch up the time of the pause.
TEST(LiveSessionPace, BeginsAnewAfterAPause) {
    constexpr int kPausedAt = 9;
    constexpr double kSpeed = 20.0;
    const auto path = std::filesystem::temp_directory_path() /
                      ("surefoot_live_pace_" + std::to_string(::getpid()));
    FailingCamera camera(false);
    Serial serial;
    auto pipeline = pipeline::Pipeline::make({}, camera.rig(), serial);
    ASSERT_TRUE(pipeline.ok()) << pipeline.error().message;
    auto writer = gate_process::SnapshotWriter::create({path.string(), {}});
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    LiveSession session(*pipeline, camera, *writer, 1);
    int frames = 0;
    std::int64_t resumed_ns = 0;
    const auto end = session.run(kSpeed, [&] {
        if (frames++ != kPausedAt) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        session.pace(kSpeed);
        resumed_ns = steady_now_ns();
        return true;
    });
    std::filesystem::remove(path);
    ASSERT_TRUE(end.ok()) << end.error().message;
    // The first frame after the pause comes at once, the others at their usual intervals.
    EXPECT_GE(steady_now_ns() - resumed_ns,
              static_cast<std::int64_t>((kFrames - kPausedAt - 1) * kPeriod_ns / kSpeed));
}

INSTANTIATE_TEST_SUITE_P(RepeatedAndTorn, LiveSessionTest, ::testing::Bool());

}  // namespace
}  // namespace surefoot::app
