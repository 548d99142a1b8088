// SPDX-License-Identifier: Apache-2.0
#include "service/live/frame_recorder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "service/console/log.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

/// Gives the calling thread the lowest priority: the gate comes before perception, and perception
/// before recording. On Linux setpriority with a thread id changes only that thread.
void stand_back() {
    constexpr int kLast = 19;
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kLast);
}

std::size_t bytes_of(const StereoFrame& frame) {
    return frame.left.size() + frame.right.size() + sizeof(float) * frame.depth_m.size();
}

/// Returns a copy of the parts of a frame that a recording stores. The samples `imu_before` come
/// before the IMU samples of the frame.
StereoFrame recorded_part(const StereoFrame& frame, std::vector<ImuSample> imu_before) {
    StereoFrame part;
    part.time_ns = frame.time_ns;
    part.index = frame.index;
    part.left = frame.left;
    part.right = frame.right;
    part.depth_m = frame.depth_m;
    part.imu = std::move(imu_before);
    part.imu.insert(part.imu.end(), frame.imu.begin(), frame.imu.end());
    return part;
}

/// Creates a new folder in `parent`. The name is the time in UTC.
Result<std::string> new_folder(const std::string& parent, std::time_t now) {
    if (auto made = io::make_folder(parent); !made) return made.error();
    const std::string name =
        io::join_path(parent, fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(now)));
    constexpr int kMostInASecond = 100;
    for (int i = 1; i <= kMostInASecond; ++i) {
        const std::string folder = i == 1 ? name : fmt::format("{}-{}", name, i);
        std::error_code error;
        if (std::filesystem::create_directory(folder, error)) return folder;
        if (error) {
            return output_error(fmt::format(
                "{}: this folder cannot be created: {}; give another folder with --record-dir",
                folder,
                error.message()));
        }
    }
    return output_error(
        fmt::format("{}: this folder and 99 folders with the same time in their names already "
                    "exist; try again in a second",
                    name));
}

/// Returns the reason why the source cannot be recorded; empty if recording is possible.
std::string why_never(const FrameRecorderConfig& config, const camera::SourceInfo& source) {
    if (config.record_dir.empty())
        return "to allow recordings, restart serve with --record-dir DIR";
    if (source.modelled_depth)
        return "this source has no images to record, because sim.sensor is analytic; restart serve "
               "with another sim.sensor";
    return {};
}

std::string megabytes(std::uint64_t bytes) {
    return fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(bytes));
}

}  // namespace

FrameRecorder::FrameRecorder(FrameRecorderConfig config,
                             const camera::StereoRig& rig,
                             const camera::SourceInfo& source,
                             page::RecordingDesk& desk)
    : config_(std::move(config)), rig_(rig), desk_(desk) {
    if (const std::string why = why_never(config_, source); !why.empty()) {
        tell(page::RecordingStage::off, why);
        return;
    }
    tell(page::RecordingStage::ready);
    desk_.serve_with([this](const page::RecordWish& wish) { ask(wish); });
    thread_ = std::thread([this] { run(); });
}

FrameRecorder::~FrameRecorder() {
    desk_.serve_with({});
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    end(End::service_ended);
    thread_.join();
}

void FrameRecorder::ask(const page::RecordWish& wish) {
    if (!wish.on) return end(End::wished);
    const std::lock_guard lock(mutex_);
    // Ignore the request while the previous recording is still being written.
    if (end_ == End::none && !stopped_) wanted_ = true;
    news_.notify_all();
}

void FrameRecorder::end(End why) {
    const std::lock_guard lock(mutex_);
    end_locked(why);
}

void FrameRecorder::end_locked(End why) {
    if (wanted_ && end_ == End::none) end_ = why;
    taking_ = false;
    news_.notify_all();
}

void FrameRecorder::source_ended() {
    end(End::source_ended);
}

void FrameRecorder::take(const StereoFrame& frame) {
    const std::lock_guard lock(mutex_);
    if (!taking_) return;
    if (last_taken_ns_ && frame.time_ns <= *last_taken_ns_) return end_locked(End::went_back);
    last_taken_ns_ = frame.time_ns;
    const std::size_t bytes = bytes_of(frame);
    if (!queue_.empty() && queued_bytes_ + bytes > config_.queue_bytes) {
        ++left_out_;
        imu_left_.insert(imu_left_.end(), frame.imu.begin(), frame.imu.end());
        return;
    }
    queue_.push_back(recorded_part(frame, std::exchange(imu_left_, {})));
    queued_bytes_ += bytes;
    news_.notify_all();
}

void FrameRecorder::run() {
    while (wait_for_wish()) {
        stand_back();
        record();
        const std::lock_guard lock(mutex_);
        wanted_ = taking_ = false;
        end_ = End::none;
        queue_.clear();
        queued_bytes_ = 0;
    }
}

/// Waits for a request to record. Returns false when the service ends.
bool FrameRecorder::wait_for_wish() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [this] { return wanted_ || stopped_; });
    return !stopped_;
}

Result<io::Recorder> FrameRecorder::open(std::string& folder) const {
    if (auto made = io::make_folder(config_.record_dir); !made) return made.error();
    const auto free = io::free_bytes(config_.record_dir);
    if (free && *free < config_.reserve_bytes) {
        return output_error(fmt::format(
            "{}: only {} are free on this disk, but {} must stay free; delete files and try again",
            config_.record_dir,
            megabytes(*free),
            megabytes(config_.reserve_bytes)));
    }
    auto made = new_folder(config_.record_dir, config_.utc_now());
    if (!made) return made.error();
    folder = *made;
    return io::Recorder::create(folder, rig_);
}

void FrameRecorder::record() {
    state_ = {};
    auto recorder = open(state_.folder);
    if (!recorder) {
        log_warning("recording: " + recorder.error().message);
        return tell(page::RecordingStage::failed, recorder.error().message);
    }
    {
        const std::lock_guard lock(mutex_);
        left_out_ = 0;
        imu_left_.clear();
        last_taken_ns_.reset();
        taking_ = end_ == End::none;
    }
    log_info(fmt::format("recording to {}, because a page started a recording", state_.folder));
    tell(page::RecordingStage::recording);
    Status written;
    while (const auto frame = next_frame()) {
        written = write(*frame, *recorder);
        if (!written) break;
    }
    conclude(written, *recorder);
}

/// Waits for the next queued frame and returns it. Returns nullopt when the recording ends and the
/// queue is empty.
std::optional<StereoFrame> FrameRecorder::next_frame() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [this] { return !queue_.empty() || end_ != End::none; });
    if (queue_.empty()) return std::nullopt;
    std::optional<StereoFrame> frame(std::move(queue_.front()));
    queue_.pop_front();
    queued_bytes_ -= bytes_of(*frame);
    return frame;
}

Status FrameRecorder::write(const StereoFrame& frame, io::Recorder& recorder) {
    const auto free = io::free_bytes(state_.folder);
    if (free && *free < config_.reserve_bytes) {
        return output_error(fmt::format(
            "the disk is almost full, and {} must stay free; delete files and record again",
            megabytes(config_.reserve_bytes)));
    }
    if (auto added = recorder.add(frame); !added) return added;
    if (state_.frames == 0) first_stamp_ns_ = frame.time_ns;
    last_stamp_ns_ = frame.time_ns;
    state_.frames = recorder.frames();
    state_.bytes = recorder.bytes();
    state_.duration_s = seconds_from_ns(last_stamp_ns_ - first_stamp_ns_);
    bool ending = false;
    {
        const std::lock_guard lock(mutex_);
        state_.left_out = left_out_;
        ending = end_ != End::none;
    }
    tell(ending ? page::RecordingStage::finishing : page::RecordingStage::recording);
    return {};
}

void FrameRecorder::tell(page::RecordingStage stage, std::string text) {
    state_.stage = stage;
    state_.text = std::move(text);
    desk_.tell(state_);
}

std::string FrameRecorder::reason_in_words() {
    const std::lock_guard lock(mutex_);
    switch (end_) {
        case End::went_back: return "; the recording ended, because the source went back in time";
        case End::source_ended: return "; the recording ended, because the source ended";
        case End::service_ended: return "; the recording ended, because the service ended";
        case End::none:
        case End::wished: break;
    }
    return {};
}

/// Closes the recording and reports its result. After a failed write, the earlier frames form a
/// valid recording.
void FrameRecorder::conclude(const Status& written, io::Recorder& recorder) {
    {
        const std::lock_guard lock(mutex_);
        taking_ = false;
        state_.left_out = left_out_;
    }
    const Status finished = recorder.finish();
    const Status& outcome = written ? finished : written;
    std::string text = fmt::format("{} frames, {:.1f} s, {} in {}{}",
                                   state_.frames,
                                   state_.duration_s,
                                   megabytes(static_cast<std::uint64_t>(state_.bytes)),
                                   state_.folder,
                                   outcome ? reason_in_words() : "; " + outcome.error().message);
    if (state_.left_out > 0)
        text +=
            fmt::format("; {} frames were left out of the recording, because the disk was too slow",
                        state_.left_out);
    if (state_.frames == 0) {  // this class created the folder, and the folder contains no frame
        std::error_code ignored;
        std::filesystem::remove_all(state_.folder, ignored);
        text = outcome ? "no frame arrived, so nothing was recorded" : outcome.error().message;
    }
    if (outcome) {
        log_info("recording: " + text);
    } else {
        log_warning("recording: " + text);
    }
    tell(outcome ? page::RecordingStage::ready : page::RecordingStage::failed, std::move(text));
}

Result<std::optional<StereoFrame>> RecordedSource::next() {
    auto frame = source_.next();
    if (frame && frame->has_value()) {
        recorder_.take(**frame);
    } else {
        recorder_.source_ended();
    }
    return frame;
}

}  // namespace surefoot::app
