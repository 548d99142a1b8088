// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/progress.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "io/recorder.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

int record(const RecordOptions& options) {
    const auto executor = make_executor(options.common);
    auto source = open_source({options.source,
                               options.rig_file,
                               options.rate_hz,
                               options.max_frames,
                               options.common.seed},
                              *executor);
    if (!source) return report(source.error());
    auto recorder = io::Recorder::create(options.out_dir, (*source)->rig());
    if (!recorder) return report(recorder.error());
    watch_for_interrupts();
    Progress progress("record", (*source)->info().frames);
    int frames = 0;
    while (!interrupted()) {
        auto frame = (*source)->next();
        if (!frame) return report(frame.error());  // what is recorded so far is a valid recording
        if (!frame->has_value()) break;
        if (auto status = recorder->add(**frame); !status) return report(status.error());
        progress.advance(++frames);
    }
    if (auto status = recorder->finish(); !status) return report(status.error());
    fmt::print("{} frames recorded in {}/\n", frames, options.out_dir);
    return interrupted() ? report({ErrorCode::interrupted,
                                   "interrupted by the user; the frames up to here are kept"})
                         : kExitOk;
}

int replay(const ReplayOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto executor = make_executor(options.common);
    auto source =
        open_source({options.source, options.rig_file, 0.0, 0, options.common.seed}, *executor);
    if (!source) return report(source.error());
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, (*source)->rig(), *executor, steady_now_ns);
    if (!pipeline) return report(pipeline.error());
    watch_for_interrupts();
    std::int64_t first_frame_ns = 0;
    std::int64_t start_ns = 0;
    int frames = 0;
    int late = 0;
    while (!interrupted()) {
        auto frame = (*source)->next();
        if (!frame) return report(frame.error());
        if (!frame->has_value()) break;
        if (frames == 0) {
            first_frame_ns = (*frame)->time_ns;
            pipeline->align({&**frame, 1});
            start_ns = steady_now_ns();
        }
        const auto due_ns =
            start_ns + static_cast<std::int64_t>(
                           static_cast<double>((*frame)->time_ns - first_frame_ns) / options.speed);
        const std::int64_t wait_ns = due_ns - steady_now_ns();
        if (wait_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait_ns));
        // A frame that comes late gets odometry only, as in a live run.
        const bool is_late = wait_ns < 0 && frames > 0;
        late += is_late ? 1 : 0;
        const FrameReport seen = pipeline->process(**frame, is_late ? Work::odometry : Work::full);
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
            is_late ? "  late" : "");
        ++frames;
    }
    fmt::print("{} frames at {:g} times real time, {} late (odometry only)\n",
               frames,
               options.speed,
               late);
    return interrupted() ? report({ErrorCode::interrupted, "interrupted by the user"}) : kExitOk;
}

int info(const InfoOptions& options) {
    const auto found = io::inspect(options.source);
    if (!found) return report(found.error());
    if (options.common.json) {
        fmt::print("{}\n", recording_json(*found));
        return kExitOk;
    }
    const io::RecordingInfo& i = *found;
    fmt::print("{}: {} frames over {:.2f} s at {:.2f} Hz, {:.1f} MB of images\n",
               i.kind,
               i.frames,
               i.duration_s,
               i.rate_hz,
               static_cast<double>(i.bytes) * 1e-6);
    fmt::print("gaps: {} (longest {:.3f} s), frames without partner: {}, missing images: {}{}\n",
               i.gaps,
               i.longest_gap_s,
               i.unpaired,
               i.missing_images,
               i.first_missing.empty() ? "" : fmt::format(" (first: {})", i.first_missing));
    fmt::print("stamps that do not grow: {}, IMU: {} samples at {:.1f} Hz, ground truth: {}\n",
               i.bad_stamps,
               i.imu_samples,
               i.imu_rate_hz,
               i.has_truth ? "yes" : "no");
    fmt::print("left camera {}x{}, baseline {:.1f} mm\n",
               i.rig.left.width,
               i.rig.left.height,
               1e3 * i.rig.T_left_right.translation_m.norm());
    return kExitOk;
}

}  // namespace surefoot::app
