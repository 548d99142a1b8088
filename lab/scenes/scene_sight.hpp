// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lab/scenes/hazard_scene.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::experiments {

/// Surfaces of a scene on one vertical line, as heights in the world frame.
struct Heights {
    double top_m = 0.0;    ///< highest surface [m]; NaN = void
    double floor_m = 0.0;  ///< surface below a hanging solid; otherwise equals `top_m`
    double under_m = 0.0;  ///< underside of a hanging solid; infinity = none
};
[[nodiscard]] Heights heights_at(const HazardScene& scene, const Eigen::Vector2d& p_m);

/// True visibility of points from the machine's path. A pose sees a point if it is in both images
/// (6 px from the border), within 2.8 m, and not occluded for either camera. Poses: every 0.15 m of
/// the path and every 45 deg of a turn.
class Sight {
  public:
    /// `scene` must outlive this object.
    Sight(const HazardScene& scene, const camera::RectifiedRig& rig);

    struct Look {
        int looks = 0;           ///< number of poses that see the point
        double nearest_m = 0.0;  ///< smallest distance from the left cameras of these poses [m]
    };
    /// Counts the poses that see a point of the world, from the last pose backwards, up to `most`.
    [[nodiscard]] Look look(const Eigen::Vector3d& p_m, int most) const;
    /// Pose of the left camera at each pose of the machine, last pose first.
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
