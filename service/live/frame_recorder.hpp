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
    std::string record_dir;  ///< parent folder of all recordings; empty = recording is off
    /// Largest size [bytes] of the queue of frames that wait for the disk. The default is enough
    /// for 4 s of stereo images of 672 x 376 px at 30 Hz.
    std::size_t queue_bytes = 64U << 20U;
    /// Least free space [bytes] of the disk; below it the recording stops. The audit log of the
    /// gate may be on the same disk.
    std::uint64_t reserve_bytes = 500'000'000;
    std::time_t (*utc_now)() = [] { return std::time(nullptr); };  ///< time in folder names (UTC)
};

/// Records the frames of a source while a web page requests it (docs/how_to/page.md), in the format
/// of `surefoot record`.
///
/// A separate thread of low priority writes to the disk. `take` only copies the frame into a queue
/// and never waits for the disk. A frame that does not fit into the queue is left out and counted.
/// Its IMU samples are stored with the next frame. All public functions are thread-safe.
class FrameRecorder {
  public:
    /// Tells the desk whether recording is possible. If not, also gives the reason.
    FrameRecorder(FrameRecorderConfig config,
                  const camera::StereoRig& rig,
                  const camera::SourceInfo& source,
                  page::RecordingDesk& desk);
    FrameRecorder(const FrameRecorder&) = delete;
    FrameRecorder& operator=(const FrameRecorder&) = delete;
    /// Writes the queued frames, then ends the recording.
    ~FrameRecorder();

    /// Queues a copy of the frame. Without an active recording it does nothing.
    void take(const StereoFrame& frame);
    /// Ends an active recording because the source delivers no more frames.
    void source_ended();

  private:
    /// Reason why a recording ended. If there are several, the first reason is kept.
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

    // Only the writing thread uses these members, and the constructor before it starts that thread.
    page::RecordingState state_;
    std::int64_t first_stamp_ns_ = 0;
    std::int64_t last_stamp_ns_ = 0;

    std::mutex mutex_;
    std::condition_variable news_;
    std::deque<StereoFrame> queue_;
    std::size_t queued_bytes_ = 0;
    std::vector<ImuSample> imu_left_;  ///< IMU samples of frames that were left out
    std::int64_t left_out_ = 0;
    std::optional<std::int64_t> last_taken_ns_;
    bool wanted_ = false;
    bool taking_ = false;  ///< true while `take` queues frames
    bool stopped_ = false;
    End end_ = End::none;
    std::thread thread_;
};

/// Wraps a source and also passes each delivered frame to a recorder. Source and recorder must
/// outlive this object.
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
