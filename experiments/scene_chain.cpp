// SPDX-License-Identifier: Apache-2.0
#include "experiments/scene_chain.hpp"

#include <fmt/format.h>

#include "apps/surefoot/run_session.hpp"
#include "apps/surefoot/settings.hpp"
#include "io/file.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::experiments {

Result<ChainRun> run_chain(const HazardScene& scene,
                           Look look,
                           double noise,
                           const std::string& scratch,
                           Executor& executor) {
    auto settings = app::load_settings({});
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
    if (look == Look::analytic) {
        sim.sensor = sim::Sensor::analytic;
        sim.known_motion = true;
        sim.drift = {0.0, 0.0};
    }
    ChainRun run;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    run.source = std::move(*source);
    // How high base_link is over its own ground is known of every carrier: it is built so.
    settings->pipeline.ground.expected_height_m =
        run.source->truth().trajectory.front().T_world_body.translation_m.z();
    auto pipeline = pipeline::Pipeline::make(
        settings->pipeline, run.source->rig(), executor, app::steady_now_ns);
    if (!pipeline) return pipeline.error();
    run.pipeline = std::make_unique<pipeline::Pipeline>(std::move(*pipeline));
    app::RunSession session(*run.pipeline, *run.source, run.source->rig(), 1, settings->maps);
    session.drive("");
    if (session.record().error) return *session.record().error;
    if (session.record().frames.empty()) return input_error(file + ": no frame was processed");
    run.T_world_body =
        run.source->truth().trajectory[session.record().frames.size() - 1].T_world_body;
    return run;
}

}  // namespace surefoot::experiments
