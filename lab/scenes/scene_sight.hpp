// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lab/scenes/hazard_scene.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::experiments {

/// What a plumb line meets in a scene.
struct Heights {
    double top_m = 0.0;    ///< highest surface; NaN: a void
    double floor_m = 0.0;  ///< the surface under what hangs there, else `top_m`
    double under_m = 0.0;  ///< where the highest thing begins, infinity where nothing hangs
};
[[nodiscard]] Heights heights_at(const HazardScene& scene, const Eigen::Vector2d& p_m);

/// Which places both eyes saw on the machine's way: in both images, within the range of the map,
/// nothing in between. A pose every 0.15 m, and every 45 deg of a turn.
class Sight {
  public:
    Sight(const HazardScene& scene, const camera::RectifiedRig& rig);

    struct Look {
        int looks = 0;           ///< poses from which it was seen
        double nearest_m = 0.0;  ///< of these, from the camera
    };
    /// Stops counting at `most` looks; they begin with the last pose.
    [[nodiscard]] Look look(const Eigen::Vector3d& p_m, int most) const;
    /// The left eye at each pose, the last one first.
    [[nodiscard]] const std::vector<Pose>& T_world_camera() const noexcept {
        return T_world_camera_;
    }

  private:
    [[nodiscard]] bool both_see(const Pose& T_world_camera, const Eigen::Vector3d& p_m) const;

    const HazardScene* scene_;
    camera::RectifiedRig rig_;
    std::vector<Pose> T_world_camera_;
};

}  // namespace surefoot::experiments
