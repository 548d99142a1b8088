// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "service/page/recording_desk.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {

struct FrameRecorderConfig {
    std::string record_dir;  ///< each recording is a new folder in it; empty = nothing is recorded
    /// Frames that wait for the disk; 4 s of 672 x 376 px at 30 Hz.
    std::size_t queue_bytes = 64U << 20U;
    /// Less is never left on the disk: the audit log of the gate may lie on it, too.
    std::uint64_t reserve_bytes = 500'000'000;
    std::time_t (*utc_now)() = [] { return std::time(nullptr); };  ///< names the folders
};

/// Records what a source delivers while the pages want it (docs/how_to/page.md), as `surefoot record`
/// does. A thread of its own writes; who brings frames only copies them, and never waits for the
/// disk: what does not fit into the queue is left out and counted. Its IMU samples come with the
/// next frame.
class FrameRecorder {
  public:
    /// Tells the desk whether anything can be recorded, and why not.
    FrameRecorder(FrameRecorderConfig config,
                  const camera::StereoRig& rig,
                  const camera::SourceInfo& source,
                  page::RecordingDesk& desk);
    FrameRecorder(const FrameRecorder&) = delete;
    FrameRecorder& operator=(const FrameRecorder&) = delete;
    /// Writes what is queued.
    ~FrameRecorder();

    /// A frame came; nothing happens while nothing is recorded.
    void take(const StereoFrame& frame);
    /// No frame comes any more: a recording ends.
    void source_ended();

  private:
    /// Why a recording ended; the first reason counts.
    enum class End : std::uint8_t { none, wished, went_back, source_ended, service_ended };

    void ask(const page::RecordWish& wish);
    void end(End why);
    void end_locked(End why);
    void run();
    [[nodiscard]] bool wait_for_wish();
    void record();
    [[nodiscard]] Result<io::Recorder> open(std::string& folder) const;
    [[nodiscard]] std::optional<StereoFrame> next_frame();
    [[nodiscard]] Status write(const StereoFrame& frame, io::Recorder& recorder);
    void tell(page::RecordingStage stage, std::string text = {});
    void conclude(const Status& written, io::Recorder& recorder);
    [[nodiscard]] std::string reason_in_words();

    const FrameRecorderConfig config_;
    const camera::StereoRig rig_;
    page::RecordingDesk& desk_;

    // Of the thread that writes.
    page::RecordingState state_;
    std::int64_t first_stamp_ns_ = 0;
    std::int64_t last_stamp_ns_ = 0;

    std::mutex mutex_;
    std::condition_variable news_;
    std::deque<StereoFrame> queue_;
    std::size_t queued_bytes_ = 0;
    std::vector<ImuSample> imu_left_;  ///< of frames that were left out
    std::int64_t left_out_ = 0;
    std::optional<std::int64_t> last_taken_ns_;
    bool wanted_ = false;
    bool taking_ = false;  ///< frames are queued
    bool stopped_ = false;
    End end_ = End::none;
    std::thread thread_;
};

/// A source whose frames are shown to a recorder as they are delivered.
class RecordedSource final : public camera::FrameSource {
  public:
    RecordedSource(camera::FrameSource& source, FrameRecorder& recorder)
        : source_(source), recorder_(recorder) {}
    [[nodiscard]] const camera::StereoRig& rig() const override { return source_.rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return source_.info(); }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

  private:
    camera::FrameSource& source_;
    FrameRecorder& recorder_;
};

}  // namespace surefoot::app
