// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"

namespace surefoot::camera {

/// Parameters of the virtual pinhole cameras of rectified images.
struct RectificationConfig {
    double rectified_focal_px = 0.0;  ///< 0 = smallest without black pixels, see max_view_deg
    int rectified_width_px = 0;       ///< 0 = width of the raw images
    int rectified_height_px = 0;
    /// Largest view angle across and down, if the focal length is chosen automatically. A wider
    /// view would reduce the resolution in the middle of a fisheye image, where the ground is.
    double max_view_deg = 105.0;

    [[nodiscard]] bool operator==(const RectificationConfig&) const = default;
    void describe(ConfigVisitor& visitor);
    /// Returns the first problem for raw images of this size, or nullopt.
    [[nodiscard]] std::optional<std::string> problem(int raw_width, int raw_height) const;
};

/// One real camera behind a rectified image.
struct RectifiedCamera {
    Camera camera;
    Eigen::Matrix3d R_rectified_raw = Eigen::Matrix3d::Identity();  ///< from raw to rectified
    double offset_x_m = 0.0;  ///< x of the camera centre in the rectified left frame
};

/// Result of the planning: the rotation of each camera, and the ideal rig of the rectified images.
struct Rectification {
    RectifiedRig rig;
    RectifiedCamera left;
    std::optional<RectifiedCamera> right;
    bool identity = false;  ///< true if raw and rectified images are equal
};

/// `rig` and `config` must have no problem(). A rectified rig stays unchanged unless `config` sets
/// another focal length or size. Without a right camera nothing is rotated: depth along z stays the
/// same, and the rig gets `virtual_baseline_m`.
[[nodiscard]] Rectification plan_rectification(const StereoRig& rig,
                                               const RectificationConfig& config,
                                               double virtual_baseline_m);

/// Returns the raw pixel that shows the direction `ray`, or nullopt outside the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> raw_from_ray(const RectifiedCamera& this_camera,
                                                          const Eigen::Vector3d& ray);

}  // namespace surefoot::camera
