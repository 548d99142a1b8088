// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

/// A camera below both limits counts as at rest. The simulator renders its frames once for the
/// whole exposure, so they do not show the cost of blur.
constexpr double kMoving_m_s = 0.02;
constexpr double kTurning_rad_s = 0.02;
/// Frame rate, so low that few frames cover the whole path with driving, turning and standing.
constexpr double kRate_hz = 2.0;

using Choose = std::function<void(sim::SceneOptions&)>;

bool moves(const sim::Motion& motion, double time_s) {
    const sim::MotionState state = motion.at(time_s);
    return state.velocity_world_m_s.norm() > kMoving_m_s ||
           state.angular_velocity_body_rad_s.norm() > kTurning_rad_s;
}

/// Times how long the simulator needs for a frame; only frames with a moving camera count.
Result<Timing> time_frames(const SourceRequest& request, Executor& executor) {
    const auto script = sim::make_scene(request.source, request.seed);
    if (!script) return script.error();
    auto source = open_simulation(request, executor);
    if (!source) return source.error();
    std::vector<double> wall_ms;
    std::vector<double> cpu_ms;
    for (int i = 0;; ++i) {
        const std::int64_t wall_ns = steady_now_ns();
        const std::int64_t cpu_ns = cpu_now_ns();
        const auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!*frame) break;
        // The first frame is a warm-up and is not timed.
        if (i == 0 || !moves(*script->motion, i / kRate_hz)) continue;
        cpu_ms.push_back(1e-6 * static_cast<double>(cpu_now_ns() - cpu_ns));
        wall_ms.push_back(1e-6 * static_cast<double>(steady_now_ns() - wall_ns));
    }
    if (cpu_ms.empty())
        return input_error("bench sim: the camera never moves in the scene " + request.source);
    const Percentiles wall = percentiles(std::move(wall_ms));
    const double least_ms = *std::min_element(cpu_ms.begin(), cpu_ms.end());
    return Timing{wall.median, wall.p99, least_ms, percentiles(std::move(cpu_ms)).median};
}

/// Times rectification, odometry and stereo matching. A source that delivers depth and motion
/// (sim.sensor = analytic) does not need these stages. All figures are processor time.
Result<Timing> time_front_end(const SourceRequest& request,
                              const Settings& settings,
                              Executor& executor) {
    auto source = open_simulation(request, executor);
    if (!source) return source.error();
    auto pipeline =
        pipeline::Pipeline::make(settings.pipeline, (*source)->rig(), executor, cpu_now_ns);
    if (!pipeline) return pipeline.error();
    RunSession session(*pipeline, **source, (*source)->rig(), 1, settings.maps);
    session.drive("");
    if (session.record().error) return *session.record().error;
    std::vector<double> sums_ms;
    for (const FrameReport& frame : session.record().frames) {
        if (frame.work != Work::full) continue;
        double sum_ms = 0.0;
        for (const Stage stage : {Stage::rectify, Stage::odometry, Stage::stereo})
            sum_ms += frame.stage_ms[static_cast<std::size_t>(stage)];
        sums_ms.push_back(sum_ms);
    }
    const Percentiles sum = percentiles(sums_ms);
    return Timing{
        sum.median, sum.p99, *std::min_element(sums_ms.begin(), sums_ms.end()), sum.median};
}

Choose images(int blur_samples) {
    return [=](sim::SceneOptions& options) { options.camera.shutter.blur_samples = blur_samples; };
}

Choose analytic(int stride) {
    return [=](sim::SceneOptions& options) {
        options.sensor = sim::Sensor::analytic;
        options.analytic.stride = stride;
    };
}

}  // namespace

Result<std::vector<BenchResult>> bench_sim(const CommonOptions& common, Executor& executor) {
    const auto settings = load_settings(common);
    if (!settings) return settings.error();
    const std::pair<const char*, Choose> ways[] = {{"sharp", images(0)},
                                                   {"4_blur_samples", images(4)},
                                                   {"analytic", analytic(1)},
                                                   {"analytic_stride_2", analytic(2)},
                                                   {"analytic_stride_4", analytic(4)},
                                                   {"analytic_stride_8", analytic(8)}};
    std::vector<BenchResult> results;
    for (const char* scene : {"demo_stairs", "room"}) {
        SourceRequest request{scene, "", kRate_hz, 0, common.seed, settings->sim};
        for (const auto& [name, choose] : ways) {
            request.sim = settings->sim;
            choose(request.sim);
            const auto timing = time_frames(request, executor);
            if (!timing) return timing.error();
            results.push_back({fmt::format("sim/{}/{}", scene, name), *timing});
        }
        // Uses the frame rate of the scene from the first frame on, because odometry needs
        // consecutive frames.
        constexpr int kChainFrames = 40;
        const auto timing = time_front_end(
            {scene, "", 0.0, kChainFrames, common.seed, settings->sim}, *settings, executor);
        if (!timing) return timing.error();
        results.push_back({fmt::format("sim/{}/depth_and_motion_from_images", scene), *timing});
    }
    return results;
}

}  // namespace surefoot::app
