// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/stairs_scenes/stairs_observation.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot::experiments {

/// One simulated run of `stairs_truth`.
struct StairsCase {
    std::string scene;
    std::uint64_t seed = 1;
    /// analytic_N: true disparities with matcher errors of sigma N px. images_0.25, images_0.5:
    /// rendered images of the `zed` profile. Their noise gives our matcher an error of about 0.25
    /// or 0.5 px on level floor. images_xF: image noise of `zed` times F.
    std::string mode;
    /// Keeps every n-th frame and measures its disparity noise. 0: keeps every frame, but measures
    /// the disparity noise of the last frame only.
    int every = 0;

    /// Sets scene, seed, sensor and noise. A usage error names an unknown mode.
    [[nodiscard]] Status put_into(sim::SceneOptions& options) const;
};

/// Runs the whole pipeline on a scene and returns the kept frames. Poses are the true ones unless
/// `settings` has sim.known_motion = false. The seed draws the scene, the height (0.95-1.05 m) and
/// pitch (28-36 deg) of the camera, and yaw and position of odom. The map cells therefore have a
/// random position in the scene.
///
/// With `every` = 0 the run ends at the end of the path, or 0.9 m before a door in it.
/// `Observation::noise_px` is 1.4826 times the median absolute deviation of the disparity errors.
/// It uses pixels that the map accepts and whose 17 x 17 px neighbourhood shows only level floor.
[[nodiscard]] Result<std::vector<Observation>> look_at(const StairsCase& now,
                                                       Settings settings,
                                                       Executor& executor);

}  // namespace surefoot::experiments
