// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/stairs_scenes/stairs_look.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot::experiments {

struct StairsCase {
    std::string scene;
    std::uint64_t seed = 1;
    /// analytic_N: disparities with a matcher's errors of N px. images_N: rendered images of the
    /// `zed` with as much noise that our matcher errs by about N px, see `put_into`; images_xF:
    /// with its noise times F.
    std::string mode;
    /// Looks at every n-th frame. 0: at every one until the end of the way, which alone is judged;
    /// the noise of the others is not measured.
    int every = 0;

    /// A usage error names a mode that is none.
    [[nodiscard]] Status put_into(sim::SceneOptions& options) const;
};

/// The scene as the whole pipeline sees it with true poses (unless `settings` say
/// sim.known_motion = false). What the seed draws beside the scene: height 0.95-1.05 m and pitch
/// 28-36 deg of the camera; yaw and place of odom, so that cells lie anyhow on the things.
///
/// Where it looks is the end of the way, before a door that the way leads through 0.9 m.
/// `Look::noise_px` is 1.4826 times the median distance of disparity errors from their median, at
/// pixels that the map would take, whose surroundings of 17 x 17 pixels are level floor too.
[[nodiscard]] Result<std::vector<Look>> look_at(const StairsCase& now,
                                                Settings settings,
                                                Executor& executor);

}  // namespace surefoot::experiments
