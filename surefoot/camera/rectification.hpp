// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"

namespace surefoot::camera {

/// The virtual pinhole pair that images are rectified to.
struct RectificationConfig {
    double rectified_focal_px = 0.0;  ///< 0 = the smallest that leaves no pixel without a source
    int rectified_width_px = 0;       ///< 0 = as the raw images
    int rectified_height_px = 0;
    /// From side to side and from top to bottom, where the focal length is chosen here: a wider
    /// view would thin out the middle of a fisheye image, where the ground is.
    double max_view_deg = 105.0;

    [[nodiscard]] bool operator==(const RectificationConfig&) const = default;
    void describe(ConfigVisitor& visitor);
    /// First reason why it cannot be used on raw images of a size, or nothing.
    [[nodiscard]] std::optional<std::string> problem(int raw_width, int raw_height) const;
};

/// One real camera behind a rectified image.
struct RectifiedCamera {
    Camera camera;
    Eigen::Matrix3d R_rectified_raw = Eigen::Matrix3d::Identity();  ///< optical frames
    double offset_x_m = 0.0;  ///< its centre on the x axis of the rectified left frame
};

/// The geometry of a rectification: how to turn each eye, and the ideal rig that results.
struct Rectification {
    RectifiedRig rig;
    RectifiedCamera left;
    std::optional<RectifiedCamera> right;
    bool identity = false;  ///< raw and rectified images are the same
};

/// `rig` and `config` must have no problem(). A rectified rig stays as it is unless `config` asks
/// for another focal length or size. Without a right camera only the distortion is removed, so that
/// depth along z stays what it is, and `virtual_baseline_m` is taken.
[[nodiscard]] Rectification plan_rectification(const StereoRig& rig,
                                               const RectificationConfig& config,
                                               double virtual_baseline_m);

/// Raw pixel that shows the direction `ray` of the rectified frame; nothing outside the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> raw_from_ray(const RectifiedCamera& this_camera,
                                                          const Eigen::Vector3d& ray);

}  // namespace surefoot::camera
