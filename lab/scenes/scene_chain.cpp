// SPDX-License-Identifier: Apache-2.0
#include "lab/scenes/scene_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "surefoot/core/time.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/start.hpp"

namespace surefoot::experiments {
namespace {

/// Runs the pipeline to the end. Returns the time of the last frame; nullopt without a frame.
/// `app::RunSession` would also compare depth and map with the truth; this comparison takes a third
/// of the time of a session.
Result<std::optional<std::int64_t>> process_all(sim::SceneSource& source,
                                                pipeline::Pipeline& pipeline) {
    std::optional<Error> failed;
    std::optional<std::int64_t> last_ns;
    const pipeline::NextFrame next = [&]() -> std::optional<StereoFrame> {
        auto frame = source.next();
        if (!frame) failed = frame.error();
        return frame ? std::move(*frame) : std::nullopt;
    };
    const auto process = [&](const StereoFrame& frame) {
        pipeline.process(frame, Work::full);
        last_ns = frame.time_ns;
    };
    const pipeline::Start start =
        pipeline::align_when_ready(pipeline, next, source.info().T_odom_first_body);
    std::for_each(start.frames.begin(), start.frames.end(), process);
    for (auto frame = next(); frame; frame = next()) process(*frame);
    if (failed) return *failed;
    return last_ns;
}

}  // namespace

Result<ChainRun> run_chain(const HazardScene& scene,
                           Look look,
                           double noise,
                           const std::string& scratch,
                           Executor& executor) {
    auto settings = surefoot::load_settings();
    if (!settings) return settings.error();
    const std::string file = fmt::format("{}/{}_{}_{}.yaml",
                                         scratch,
                                         kHazardNames[static_cast<int>(scene.asked)],
                                         scene.relief_only ? "relief" : "hazard",
                                         scene.seed);
    if (auto written = io::write_file(file, scene.yaml()); !written) return written.error();
    sim::SceneOptions& sim = settings->sim;
    sim.scene = file;
    sim.seed = scene.seed;
    sim.noise = noise;
    sim.profile = sim::CameraProfile::zed;
    if (look == Look::large_images) sim.rig_preset = "zed_hd720";
    if (look == Look::analytic) {
        sim.sensor = sim::Sensor::analytic;
        sim.known_motion = true;
        sim.drift = {0.0, 0.0};
    }
    ChainRun run;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    run.source = std::move(*source);
    // The height of base_link above its own ground is known from the construction of the machine.
    settings->pipeline.ground.expected_height_m =
        run.source->truth().trajectory.front().T_world_body.translation_m.z();
    auto pipeline =
        pipeline::Pipeline::make(settings->pipeline, run.source->rig(), executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    run.pipeline = std::make_unique<pipeline::Pipeline>(std::move(*pipeline));
    auto last = process_all(*run.source, *run.pipeline);
    if (!last) return last.error();
    if (!*last) return input_error(file + ": no frame was processed; check the scene's motion");
    for (const StampedPose& pose : run.source->truth().trajectory)
        if (pose.time_ns <= **last) run.T_world_body = pose.T_world_body;
    return run;
}

}  // namespace surefoot::experiments
