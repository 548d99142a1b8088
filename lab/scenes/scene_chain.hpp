// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "lab/scenes/hazard_scene.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::experiments {

/// Input of the pipeline in a simulated run.
enum class Look : std::uint8_t {
    analytic,      ///< true disparities with the errors of a matcher, and true motion
    images,        ///< rendered images of the fitted ZED profile; matcher and odometry use them
    large_images,  ///< the same with 1280 x 720 px, so the ground in front is matched finely
};

/// State after the last frame of a run.
struct ChainRun {
    std::unique_ptr<sim::SceneSource> source;
    std::unique_ptr<pipeline::Pipeline> pipeline;
    Pose T_world_body;  ///< true pose at the last frame
};

/// Runs the pipeline along the scene's path. `scene` must be placed `on_way`. `scratch`: folder for
/// the scene file. `noise`: factor on the noise of images and disparities.
[[nodiscard]] Result<ChainRun> run_chain(const HazardScene& scene,
                                         Look look,
                                         double noise,
                                         const std::string& scratch,
                                         Executor& executor);

}  // namespace surefoot::experiments
