// SPDX-License-Identifier: Apache-2.0
#include "service/live/live_session.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "service/console/interrupt.hpp"
#include "service/live/paced_time.hpp"
#include "surefoot/pipeline/start.hpp"

namespace surefoot::app {

void Arrivals::note(std::int64_t stamp_ns, std::int64_t steady_ns) noexcept {
    last_[next_] = {stamp_ns, steady_ns};
    next_ = (next_ + 1) % last_.size();
}

std::int64_t Arrivals::steady_ns(std::int64_t stamp_ns) const noexcept {
    for (const Arrival& arrival : last_) {
        if (arrival.steady_ns != 0 && arrival.stamp_ns == stamp_ns) return arrival.steady_ns;
    }
    return 0;
}

LiveSession::LiveSession(pipeline::Pipeline& pipeline,
                         camera::FrameSource& source,
                         gate_process::SnapshotWriter& writer,
                         std::uint64_t config_hash,
                         SteadyClock clock)
    : pipeline_(pipeline),
      source_(source),
      writer_(writer),
      config_hash_(config_hash),
      clock_(std::move(clock)),
      cameras_(source.info().path),
      snapshot_(std::make_unique<grid::MapSnapshot>()) {}

void LiveSession::wait_for(std::int64_t stamp_ns) {
    if (speed_ <= 0.0 || source_.info().steady_stamps) return;
    if (first_steady_ns_ == 0) {
        first_stamp_ns_ = stamp_ns;
        first_steady_ns_ = clock_();
    }
    const std::int64_t due_ns = first_steady_ns_ + paced_ns(stamp_ns - first_stamp_ns_, speed_);
    const std::int64_t wait_ns = due_ns - clock_();
    if (wait_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait_ns));
}

void LiveSession::pace(double speed) noexcept {
    speed_ = speed;
    first_steady_ns_ = 0;
}

/// Returns the steady time at which a frame that just arrived was exposed. For a live camera this
/// is the stamp of the frame, because the frame may have waited in the driver or on the wire. A
/// stamp in the future stays unchanged: the age of the image is unknown, and the gate refuses such
/// a frame.
std::int64_t LiveSession::exposed_ns(std::int64_t stamp_ns) const {
    return source_.info().steady_stamps ? stamp_ns : clock_();
}

std::optional<StereoFrame> LiveSession::next() {
    if (error_ || end_) return std::nullopt;
    if (interrupted() || !before_frame_()) {
        end_ = End::stopped;
        return std::nullopt;
    }
    if (writer_.restart_wanted()) {
        end_ = End::restart_wanted;
        return std::nullopt;
    }
    auto frame = source_.next();
    if (!frame) {
        error_ = frame.error();
        return std::nullopt;
    }
    if (!frame->has_value()) {
        end_ = End::source_ended;
        return std::nullopt;
    }
    wait_for((*frame)->time_ns);
    arrivals_.note((*frame)->time_ns, exposed_ns((*frame)->time_ns));
    return std::move(frame).value();
}

/// Publishes a snapshot; returns the stamp of the last frame that updated the map.
Result<std::int64_t> LiveSession::publish() {
    if (auto status = pipeline_.snapshot(config_hash_, *snapshot_); !status) return status.error();
    const std::int64_t map_time_ns = snapshot_->frame_time_ns;
    snapshot_->version = ++published_;
    snapshot_->frame_time_ns = arrivals_.steady_ns(snapshot_->frame_time_ns);
    snapshot_->pose_time_ns = arrivals_.steady_ns(snapshot_->pose_time_ns);
    grid::seal(*snapshot_);
    writer_.publish(*snapshot_);
    return map_time_ns;
}

Result<LiveSession::End> LiveSession::run(double speed,
                                          const BeforeFrame& before_frame,
                                          const AfterFrame& after_frame) {
    pace(speed);
    before_frame_ = before_frame;
    const pipeline::Start start = pipeline::align_when_ready(
        pipeline_, [this] { return next(); }, source_.info().T_odom_first_body);
    const auto process = [&](const StereoFrame& frame) -> Status {
        const FrameReport report = pipeline_.process(frame, Work::full);
        if (auto cameras = cameras_.check(pipeline_, report); !cameras) return cameras;
        const auto map_time_ns = publish();
        if (!map_time_ns) return map_time_ns.error();
        if (after_frame) after_frame(report, *map_time_ns);
        return {};
    };
    for (const StereoFrame& frame : start.frames) {
        if (auto status = process(frame); !status) return status.error();
    }
    while (!error_ && !end_) {
        const auto frame = next();
        if (!frame) break;
        if (auto status = process(*frame); !status) return status.error();
    }
    if (error_) return *error_;
    return end_.value_or(End::source_ended);
}

}  // namespace surefoot::app
