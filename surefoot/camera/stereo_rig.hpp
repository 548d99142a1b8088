// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::camera {

/// An IMU that is fixed to the rig, with its sample rate.
struct ImuMount {
    Pose T_body_imu;
    double rate_hz = 200.0;
};

/// Two cameras on one body, or one camera that measures depth itself (RGB-D).
struct StereoRig {
    std::string name;
    Camera left;
    std::optional<Camera> right;  ///< empty for RGB-D
    Pose T_left_right;  ///< right optical frame in the left optical frame; baseline along +x
    /// Left optical frame in base_link, if the rig knows it (EuRoC T_BS) or a machine file sets
    /// it.
    std::optional<Pose> T_body_left;
    std::optional<ImuMount> imu;
    double rate_hz = 0.0;  ///< nominal frame rate, 0 = unknown
    /// Rolling-shutter read-out time from the first to the last row; 0 = global shutter. The stamp
    /// of a frame is the middle of the exposure of its middle row.
    double readout_s = 0.0;
    bool rectified = false;  ///< images are already rectified: rows match, no distortion

    /// Returns the first problem of the rig, with the value, or nullopt if the rig is valid.
    [[nodiscard]] std::optional<std::string> problem() const;
    /// Returns `T_body_left`; without it, base_link is the left camera in body axes.
    [[nodiscard]] Pose body_from_left() const;
};

/// The ideal stereo camera behind rectified images: parallel optical axes, equal intrinsics.
/// Depth along z is fx * baseline / disparity.
struct RectifiedRig {
    int width = 0;
    int height = 0;
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double baseline_m = 0.0;  ///< for RGB-D: a virtual baseline
    Pose T_body_camera;       ///< pose of the rectified left optical frame in base_link

    [[nodiscard]] double depth_to_disparity_px_m() const noexcept { return fx_px * baseline_m; }
    /// Point of a pixel in the rectified left optical frame, from its disparity (> 0).
    [[nodiscard]] Eigen::Vector3d point(double u_px, double v_px, double disparity_px) const {
        const double z_m = depth_to_disparity_px_m() / disparity_px;
        return {(u_px - cx_px) / fx_px * z_m, (v_px - cy_px) / fy_px * z_m, z_m};
    }
};

}  // namespace surefoot::camera
