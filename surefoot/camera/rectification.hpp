// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::camera {

/// One real camera behind a rectified image.
struct RectifiedEye {
    Camera camera;
    Eigen::Matrix3d R_rectified_raw = Eigen::Matrix3d::Identity();  ///< optical frames
    double offset_x_m = 0.0;  ///< its centre on the x axis of the rectified left frame
};

/// The geometry of a rectification: how to turn each eye, and the ideal rig that results.
struct Rectification {
    RectifiedRig rig;
    RectifiedEye left;
    std::optional<RectifiedEye> right;
    bool identity = false;  ///< raw and rectified images are the same
};

/// `max_field_of_view_deg` limits what is shown from side to side and from top to bottom. `rig`
/// must have no problem(). Without a right camera only the distortion is removed, so that depth
/// along z stays what it is, and `virtual_baseline_m` is taken.
[[nodiscard]] Rectification plan_rectification(const StereoRig& rig,
                                               double max_field_of_view_deg,
                                               double virtual_baseline_m);

/// Raw pixel that shows the direction `ray` of the rectified frame; nothing outside the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> raw_from_ray(const RectifiedEye& eye,
                                                          const Eigen::Vector3d& ray);

}  // namespace surefoot::camera
