// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "service/live/paced_time.hpp"
#include "studies/runs/run_output.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/perception/fit_settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/pipeline/start.hpp"

namespace surefoot::app {
namespace {

struct ReplayOptions : SourceOptions {
    CommonOptions common;
    std::string machine;
    double speed = 1.0;
};

/// Delays each frame until its time on the steady clock.
class Schedule {
  public:
    Schedule(std::int64_t first_frame_ns, double speed)
        : start_ns_(steady_now_ns()), first_frame_ns_(first_frame_ns), speed_(speed) {}

    /// Sleeps until the frame is due. Returns false if the frame is already late.
    [[nodiscard]] bool wait_for(std::int64_t frame_ns) const {
        const std::int64_t due_ns = start_ns_ + paced_ns(frame_ns - first_frame_ns_, speed_);
        const std::int64_t wait_ns = due_ns - steady_now_ns();
        if (wait_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait_ns));
        return wait_ns >= 0;
    }

  private:
    std::int64_t start_ns_;
    std::int64_t first_frame_ns_;
    double speed_;
};

void print_frame(const FrameReport& seen, std::int64_t first_frame_ns) {
    const Eigen::Vector3d& p = seen.motion.T_odom_body.translation_m;
    fmt::print(
        "{:6d} {:9.3f} s  x {:7.3f} y {:7.3f} z {:7.3f} m  {:<8} {:4d} inliers {:6d} cells{}\n",
        seen.index,
        seconds_from_ns(seen.time_ns - first_frame_ns),
        p.x(),
        p.y(),
        p.z(),
        to_string(seen.motion.health),
        seen.motion.inliers,
        seen.known_cells,
        !seen.frame_status.is_new_and_whole() ? "  repeated or torn image"
        : seen.work == Work::odometry         ? "  late"
                                              : "");
}

/// Plays until the end of the source, the first error or an interrupt by the user.
Status play(const ReplayOptions& options,
            camera::FrameSource& source,
            pipeline::Pipeline& pipeline,
            std::vector<FrameReport>& seen) {
    Status ended;
    const pipeline::NextFrame next = [&]() -> std::optional<StereoFrame> {
        if (interrupted()) ended = Error{ErrorCode::interrupted, "interrupted by the user"};
        Result<std::optional<StereoFrame>> frame = std::optional<StereoFrame>();
        if (ended) frame = source.next();
        if (!frame) ended = frame.error();
        if (!frame || !frame->has_value()) return std::nullopt;
        return std::move(frame).value();
    };
    const auto process = [&](const StereoFrame& frame, Work work) {
        seen.push_back(pipeline.process(frame, work));
        if (!options.common.json) print_frame(seen.back(), seen.front().time_ns);
    };
    const pipeline::Start start =
        pipeline::align_when_ready(pipeline, next, source.info().T_odom_first_body);
    for (const StereoFrame& frame : start.frames) process(frame, Work::full);
    if (start.frames.empty()) return ended;
    // Playback time starts when the frame odom is defined.
    const Schedule schedule(start.frames.back().time_ns, options.speed);
    while (const auto frame = next()) {
        // A late frame gets odometry only, as in a live run.
        process(*frame, schedule.wait_for(frame->time_ns) ? Work::full : Work::odometry);
    }
    return ended;
}

/// `surefoot replay`: plays a recording at a given speed.
int replay(const ReplayOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    const auto executor = make_executor(options.common);
    auto source = open_source(request_of(options, options.common, *settings), *executor);
    if (!source) return report(source.error());
    auto pipeline = pipeline::Pipeline::make(
        settings->pipeline, mounted_rig((*source)->rig(), *machine), *executor, steady_now_ns);
    if (!pipeline) return report(pipeline.error());
    watch_for_interrupts();
    std::vector<FrameReport> seen;
    const Status played = play(options, **source, *pipeline, seen);
    const auto late = std::count_if(seen.begin(), seen.end(), [](const FrameReport& frame) {
        return frame.work == Work::odometry && frame.frame_status.is_new_and_whole();
    });
    if (options.common.json) {
        print_answer(replay_json(seen, options.speed, late, (*source)->info()));
    } else {
        fmt::print(
            "{} frames played at {:g} times real time; {} frames were late and got odometry "
            "only\n{}",
            seen.size(),
            options.speed,
            late,
            broken_text((*source)->info().broken));
    }
    return played ? kExitOk : report(played.error());
}

}  // namespace

void add_replay(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<ReplayOptions>("replay",
                                 "play a recording in real time and print the result of each frame",
                                 "surefoot replay out/floor_recording --speed 20",
                                 replay);
    verb.option("source",
                o.source,
                "source to play: a recording, a video, sim:SCENE or v4l2:DEVICE; 'surefoot run "
                "--help' lists all kinds")
        .required()
        .value("SOURCE");
    add_reading(verb, o.reading);
    add_skip_broken(verb, o.reading);
    verb.option("--rig",
                o.rig_file,
                "calibration file; it replaces the calibration of the source. For a simulated "
                "scene also the name of a built-in rig, for example zed_vga")
        .value("FILE");
    verb.option("--machine",
                o.machine,
                "machine that carries the camera: a machine file, or the name of a built-in "
                "machine. It sets the position of the camera on the machine")
        .value("FILE|NAME");
    verb.option("--speed", o.speed, "playback speed as a factor of real time (default 1)")
        .in(0.01, 1000.0);
}

}  // namespace surefoot::app
