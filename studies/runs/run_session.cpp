// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_session.hpp"

#include <fmt/format.h>

#include <exception>

#include "service/console/interrupt.hpp"
#include "service/console/progress.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/pipeline/start.hpp"

namespace surefoot::app {

Trajectory trajectory_of(std::span<const FrameReport> frames, const Pose& T_body_fixed) {
    Trajectory trajectory;
    trajectory.reserve(frames.size());
    for (const FrameReport& frame : frames)
        trajectory.push_back({frame.time_ns, frame.motion.T_odom_body * T_body_fixed});
    return trajectory;
}

RunSession::RunSession(pipeline::Pipeline& pipeline,
                       camera::FrameSource& source,
                       const camera::StereoRig& rig,
                       int depth_every,
                       const eval::EvalMapsConfig& maps)
    : pipeline_(pipeline),
      source_(source),
      depth_every_(depth_every),
      maps_(maps),
      cameras_(source.info().path),
      truth_(source) {
    record_.source = source.info();
    record_.rig = rig;
}

void RunSession::drive(const std::string& label, const AfterFrame& after_frame) {
    const std::int64_t start_ns = steady_now_ns();
    quiet_ = label.empty();
    watch_for_interrupts();
    try {
        process_all(label, after_frame);
    } catch (const std::exception& error) {
        // A library may throw, for example when memory is exhausted. The results so far are kept.
        record_.error = input_error(
            fmt::format("{}: the run ended after {} frames: {}; the results up to here are kept",
                        record_.source.path,
                        record_.frames.size(),
                        error.what()));
    }
    record_.source.broken = source_.info().broken;
    if (record_.frames.empty() && !record_.error) {
        const camera::BrokenFrames& broken = record_.source.broken;
        record_.error = input_error(fmt::format(
            "{}: the source has no {}frame{}",
            record_.source.path,
            broken.count > 0 ? "intact " : "",
            broken.count > 0
                ? fmt::format(" ({} are broken; the first: {})", broken.count, broken.first)
                : ""));
    }
    record_.truth = truth_.figures(pipeline_, record_.frames, maps_);
    record_.wall_s = seconds_from_ns(steady_now_ns() - start_ns);
}

void RunSession::process_all(const std::string& label, const AfterFrame& after_frame) {
    Progress progress(label, record_.source.frames);
    const pipeline::Start start = pipeline::align_when_ready(
        pipeline_, [this] { return next_frame(); }, record_.source.T_odom_first_body);
    record_.waited_frames = start.waited_frames;
    for (const StereoFrame& frame : start.frames) {
        process(frame, after_frame);
        progress.advance(static_cast<int>(record_.frames.size()));
    }
    while (!record_.error) {
        const auto frame = next_frame();
        if (!frame) break;
        process(*frame, after_frame);
        progress.advance(static_cast<int>(record_.frames.size()));
    }
}

std::optional<StereoFrame> RunSession::next_frame() {
    Result<std::optional<StereoFrame>> frame = std::optional<StereoFrame>();
    if (!interrupted()) frame = source_.next();
    if (!frame) {
        record_.error = frame.error();
        return std::nullopt;
    }
    // A user interrupt while a live camera waits also ends the stream.
    if (!frame->has_value() && interrupted()) {
        record_.error = Error{ErrorCode::interrupted,
                              "interrupted by the user; the results up to here are kept"};
    }
    if (frame->has_value()) truth_.remember_depth(**frame);
    return std::move(frame).value();
}

void RunSession::process(const StereoFrame& frame, const AfterFrame& after_frame) {
    const bool full = frame.index % depth_every_ == 0;
    const FrameReport report = pipeline_.process(frame, full ? Work::full : Work::odometry);
    if (report.work == Work::full) truth_.compare_depth(frame, pipeline_);
    if (const Status cameras = cameras_.check(pipeline_, report, quiet_);
        !cameras && !record_.error)
        record_.error = cameras.error();
    record_.fusion += report.fusion;
    record_.frame_status += report.frame_status;
    record_.frames.push_back(report);
    if (after_frame) after_frame(report);
}

}  // namespace surefoot::app
