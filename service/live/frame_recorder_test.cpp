// SPDX-License-Identifier: Apache-2.0
#include "service/live/frame_recorder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::app {
namespace {

namespace fs = std::filesystem;
using page::RecordingStage;

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr std::int64_t kPeriod_ns = 50'000'000;
constexpr std::time_t kNow_s = 1'795'528'118;
const std::string kName = "20261124T134838Z";

camera::StereoRig rig() {
    camera::StereoRig rig = camera::test::ideal_rig(kWidth, kHeight, 120.0);
    rig.imu = camera::ImuMount{Pose{}, 20.0};
    return rig;
}

/// A frame of noise, with one IMU sample just before it.
StereoFrame frame_at(int index) {
    Rng rng(static_cast<std::uint64_t>(index) + 1);
    StereoFrame frame;
    frame.index = index;
    frame.time_ns = 1'000'000'000 + index * kPeriod_ns;
    frame.left = frame.right = GreyImage(kWidth, kHeight);
    for (std::size_t i = 0; i < frame.left.size(); ++i) {
        frame.left.data()[i] = static_cast<std::uint8_t>(rng.below(256));
        frame.right.data()[i] = static_cast<std::uint8_t>(rng.below(256));
    }
    ImuSample sample;
    sample.time_ns = frame.time_ns - 1'000'000;
    sample.specific_force_m_s2 = {0.0, 0.0, 9.81};
    frame.imu.push_back(sample);
    return frame;
}

/// A source that delivers a given number of frames (0, 1, ...) and then ends.
class CountedSource final : public camera::FrameSource {
  public:
    explicit CountedSource(int frames) : left_(frames) {}
    [[nodiscard]] const camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (left_-- <= 0) return std::optional<StereoFrame>{};
        return std::optional<StereoFrame>(frame_at(next_++));
    }

  private:
    camera::StereoRig rig_;
    camera::SourceInfo info_;
    int left_;
    int next_ = 0;
};

class FrameRecorderTest : public ::testing::Test {
  protected:
    void SetUp() override {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        config_.record_dir = folder_ / "rec";
        config_.reserve_bytes = 0;
        config_.utc_now = [] { return kNow_s; };
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Waits until the desk reports the stage; the test fails on timeout.
    page::RecordingState wait_for(RecordingStage stage) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (desk_.state().stage != stage && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        EXPECT_EQ(desk_.state().stage, stage) << desk_.state().text;
        return desk_.state();
    }
    void begin() {
        ASSERT_TRUE(desk_.ask({true}));
        wait_for(RecordingStage::recording);
    }
    [[nodiscard]] std::string recorded(const std::string& name = kName) const {
        return (folder_ / "rec" / name).string();
    }
    [[nodiscard]] io::RecordingInfo info(const std::string& name = kName) const {
        return io::inspect(recorded(name)).value();
    }

    const fs::path folder_ =
        fs::temp_directory_path() / ("surefoot_frame_recorder_" + std::to_string(::getpid()));
    FrameRecorderConfig config_;
    page::RecordingDesk desk_;
};

TEST_F(FrameRecorderTest, IsOffWithoutAFolder) {
    config_.record_dir.clear();
    FrameRecorder recorder(config_, rig(), {}, desk_);
    EXPECT_EQ(desk_.state().stage, RecordingStage::off);
    EXPECT_NE(desk_.state().text.find("--record-dir"), std::string::npos);
    EXPECT_FALSE(desk_.ask({true}));
    recorder.take(frame_at(0));
}

TEST_F(FrameRecorderTest, IsOffWhereNobodyMadeImages) {
    camera::SourceInfo modelled;
    modelled.modelled_depth = true;
    const FrameRecorder recorder(config_, rig(), modelled, desk_);
    EXPECT_EQ(desk_.state().stage, RecordingStage::off);
    EXPECT_NE(desk_.state().text.find("analytic"), std::string::npos);
}

TEST_F(FrameRecorderTest, WhatCameInBetweenIsARecording) {
    FrameRecorder recorder(config_, rig(), {}, desk_);
    recorder.take(frame_at(0));  // before the request
    begin();
    for (int i = 1; i <= 20; ++i) recorder.take(frame_at(i));
    ASSERT_TRUE(desk_.ask({false}));
    recorder.take(frame_at(21));  // too late
    const page::RecordingState state = wait_for(RecordingStage::ready);
    EXPECT_EQ(state.frames, 20);
    EXPECT_EQ(state.left_out, 0);
    EXPECT_NEAR(state.duration_s, 19 * 0.05, 1e-9);
    EXPECT_EQ(state.bytes, info().bytes);
    EXPECT_EQ(state.folder, recorded());
    EXPECT_EQ(info().frames, 20);
    EXPECT_EQ(info().imu_samples, 20);
    auto source = io::open_source(recorded(), {});
    ASSERT_TRUE(source) << source.error().message;
    const auto first = (*source)->next();
    ASSERT_TRUE(first && first->has_value());
    EXPECT_EQ((*first)->time_ns, frame_at(1).time_ns);
    const GreyImage expected = frame_at(1).right;
    EXPECT_TRUE(
        std::equal(expected.data(), expected.data() + expected.size(), (*first)->right.data()));
}

TEST_F(FrameRecorderTest, NothingIsEverOverwritten) {
    FrameRecorder recorder(config_, rig(), {}, desk_);
    for (const auto* name : {"", "-2", "-3"}) {
        begin();
        recorder.take(frame_at(1));
        ASSERT_TRUE(desk_.ask({false}));
        wait_for(RecordingStage::ready);
        EXPECT_EQ(info(kName + name).frames, 1);
    }
}

TEST_F(FrameRecorderTest, WhatADiskIsTooSlowForIsLeftOutAndCounted) {
    config_.queue_bytes = 2 * kWidth * kHeight;  // room for one frame
    FrameRecorder recorder(config_, rig(), {}, desk_);
    begin();
    constexpr int kFrames = 300;
    std::vector<StereoFrame> frames;
    for (int i = 0; i < kFrames; ++i) frames.push_back(frame_at(i));
    for (const StereoFrame& frame : frames) recorder.take(frame);
    ASSERT_TRUE(desk_.ask({false}));
    const page::RecordingState state = wait_for(RecordingStage::ready);
    EXPECT_GT(state.frames, 0);
    EXPECT_GT(state.left_out, 0);
    EXPECT_EQ(state.frames + state.left_out, kFrames);
    EXPECT_NE(state.text.find("left out"), std::string::npos) << state.text;
    EXPECT_EQ(info().frames, state.frames);
    // The IMU samples have no gap up to the last written frame.
    EXPECT_EQ(info().imu_samples, std::lround(state.duration_s / 0.05) + 1);
}

TEST_F(FrameRecorderTest, AServiceThatEndsWritesWhatWaits) {
    {
        FrameRecorder recorder(config_, rig(), {}, desk_);
        begin();
        for (int i = 0; i < 10; ++i) recorder.take(frame_at(i));
    }
    EXPECT_EQ(info().frames, 10);
    EXPECT_FALSE(desk_.ask({true})) << "nobody is there";
}

TEST_F(FrameRecorderTest, ASourceThatEndsEndsItsRecording) {
    CountedSource source(5);
    FrameRecorder recorder(config_, rig(), {}, desk_);
    RecordedSource recorded_source(source, recorder);
    begin();
    while (recorded_source.next().value()) continue;
    EXPECT_NE(wait_for(RecordingStage::ready).text.find("because the source ended"),
              std::string::npos);
    EXPECT_EQ(info().frames, 5);
}

TEST_F(FrameRecorderTest, ARecordingNeverGoesBackInTime) {
    FrameRecorder recorder(config_, rig(), {}, desk_);
    begin();
    for (const int i : {5, 6, 2, 3}) recorder.take(frame_at(i));
    EXPECT_NE(wait_for(RecordingStage::ready).text.find("back in time"), std::string::npos);
    EXPECT_EQ(info().frames, 2);
}

TEST_F(FrameRecorderTest, WithoutAFrameNothingIsLeft) {
    FrameRecorder recorder(config_, rig(), {}, desk_);
    begin();
    EXPECT_TRUE(fs::exists(recorded()));
    ASSERT_TRUE(desk_.ask({false}));
    EXPECT_NE(wait_for(RecordingStage::ready).text.find("no frame arrived"), std::string::npos);
    EXPECT_FALSE(fs::exists(recorded()));
}

TEST_F(FrameRecorderTest, AFolderThatCannotBeMadeIsSaid) {
    std::ofstream(folder_ / "file") << "in the way";
    config_.record_dir = folder_ / "file" / "rec";
    const FrameRecorder recorder(config_, rig(), {}, desk_);
    ASSERT_TRUE(desk_.ask({true}));
    const page::RecordingState state = wait_for(RecordingStage::failed);
    EXPECT_NE(state.text.find("file/rec: cannot make this folder"), std::string::npos)
        << state.text;
}

TEST_F(FrameRecorderTest, ADiskIsNeverFilledToTheBrim) {
    config_.reserve_bytes = 1ULL << 60U;
    const FrameRecorder recorder(config_, rig(), {}, desk_);
    ASSERT_TRUE(desk_.ask({true}));
    EXPECT_NE(wait_for(RecordingStage::failed).text.find("free on this disk"), std::string::npos);
}

/// Limits the file size while it lives, so that writes fail as on a full disk.
class FullDisk {
  public:
    FullDisk() {
        before_signal_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{1000, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &now);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, before_signal_);
    }

  private:
    rlimit before_{};
    void (*before_signal_)(int) = SIG_DFL;
};

TEST_F(FrameRecorderTest, AnErrorOfTheDiskIsSaidAndWhatWasBeforeItIsKept) {
    FrameRecorder recorder(config_, rig(), {}, desk_);
    begin();
    for (int i = 0; i < 3; ++i) recorder.take(frame_at(i));
    while (desk_.state().frames < 3) std::this_thread::yield();
    {
        const FullDisk full;
        recorder.take(frame_at(3));
        const page::RecordingState state = wait_for(RecordingStage::failed);
        EXPECT_NE(state.text.find("3 frames"), std::string::npos) << state.text;
        EXPECT_NE(state.text.find(".png"), std::string::npos) << state.text;
    }
    EXPECT_EQ(info().frames, 3);
    begin();  // a new recording is possible after the failure
    recorder.take(frame_at(4));
    ASSERT_TRUE(desk_.ask({false}));
    wait_for(RecordingStage::ready);
    EXPECT_EQ(info(kName + "-2").frames, 1);
}

}  // namespace
}  // namespace surefoot::app
