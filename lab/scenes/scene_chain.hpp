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

/// What looks at the scene on the way.
enum class Look : std::uint8_t {
    analytic,  ///< depth as a matcher would say it, true motion
    images,    ///< rendered images of the fitted ZED, and the whole chain
};

/// A run of the chain that has come to its end.
struct ChainRun {
    std::unique_ptr<sim::SceneSource> source;
    std::unique_ptr<pipeline::Pipeline> pipeline;
    Pose T_world_body;  ///< true, at the last frame
};

/// Walks the scene's way (it must be placed on it) with the chain. `scratch`: a folder for the
/// scene's file. `noise`: factor on the noise of images and depths.
[[nodiscard]] Result<ChainRun> run_chain(const HazardScene& scene,
                                         Look look,
                                         double noise,
                                         const std::string& scratch,
                                         Executor& executor);

}  // namespace surefoot::experiments
