// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/sim/scene_source.hpp"

/// Shared arguments of the experiments on simulated scenes: SCENES [FIRST_SEED [SEEDS [PROFILES]]].
/// SCENES and PROFILES are comma-separated lists. FIRST_SEED and SEEDS default to 1, PROFILES to
/// ideal,zed. A profile is a camera profile of the simulator, or zed_calibrated, which is zed
/// without its calibration error.
namespace surefoot::experiments {

/// One scene, seed and camera profile.
struct SceneCase {
    std::string scene;
    std::uint64_t seed = 1;
    std::string profile;

    /// Sets scene, seed and profile in `options`. A usage error names an unknown profile.
    [[nodiscard]] Status put_into(sim::SceneOptions& options) const {
        options.scene = scene;
        options.seed = seed;
        const bool calibrated = profile == "zed_calibrated";
        for (int i = 0; i < static_cast<int>(std::size(sim::kCameraProfileNames)); ++i) {
            if ((calibrated ? "zed" : profile) != sim::kCameraProfileNames[i]) continue;
            options.profile = static_cast<sim::CameraProfile>(i);
            if (!calibrated) return {};
            const sim::CalibrationError error = sim::figures_of(options.profile).calibration;
            options.calibration_error = {.right_roll_rad = -error.right_roll_rad,
                                         .right_pitch_rad = -error.right_pitch_rad,
                                         .right_yaw_rad = -error.right_yaw_rad,
                                         .right_focal_share = -error.right_focal_share};
            return {};
        }
        return usage_error("there is no profile " + profile);
    }
};

/// Expands the arguments `words` (SCENES first; not empty) to all cases, ordered by profile, scene,
/// seed.
[[nodiscard]] inline std::vector<SceneCase> scene_cases(const std::vector<std::string>& words) {
    const auto number = [&](std::size_t i) {
        return words.size() > i ? std::strtoull(words[i].c_str(), nullptr, 10) : 1;
    };
    const std::string profiles = words.size() > 3 ? words[3] : "ideal,zed";
    std::vector<SceneCase> cases;
    for (const std::string_view profile : io::split(profiles, ",")) {
        for (const std::string_view scene : io::split(words.front(), ",")) {
            for (std::uint64_t k = 0; k < number(2); ++k)
                cases.push_back({std::string(scene), number(1) + k, std::string(profile)});
        }
    }
    return cases;
}

/// Returns the rig that renders the images: the nominal rig with the calibration errors of the
/// profile and of the settings.
[[nodiscard]] inline camera::StereoRig true_rig(const camera::StereoRig& nominal,
                                                const sim::SceneOptions& sim) {
    return sim::with_error(sim::with_error(nominal, sim::figures_of(sim.profile).calibration),
                           sim.calibration_error);
}

/// Returns the true pose of base_link at a frame's time: the first pose of `trajectory` that is not
/// earlier, or the last pose. `trajectory` must be sorted by time and not empty.
[[nodiscard]] inline Pose true_pose(const std::vector<StampedPose>& trajectory,
                                    std::int64_t time_ns) {
    const auto found = std::lower_bound(
        trajectory.begin(),
        trajectory.end(),
        time_ns,
        [](const StampedPose& pose, std::int64_t stamp) { return pose.time_ns < stamp; });
    return (found == trajectory.end() ? trajectory.back() : *found).T_world_body;
}

}  // namespace surefoot::experiments
