// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "surefoot/camera/right_camera_correction.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/stereo/pair_check.hpp"

namespace surefoot::stereo {

struct SelfCalibrationConfig {
    bool enabled = true;
    int min_corners = 150;  ///< fewer corners give no estimate
    /// Larger corrections are rejected: the rig then needs a new calibration.
    double max_turn_deg = 0.6;
    double max_focal_share = 0.01;

    void describe(ConfigVisitor& visitor);
};

/// Correction of the right camera, estimated from the row errors of a rectified pair.
struct RigSelfCalibration {
    camera::RightCameraCorrection camera;             ///< yaw stays 0
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< roll [rad], pitch [rad] and focal share
    int corners = 0;
    double row_error_px = 0.0;       ///< median of the absolute row error before the correction
    double row_error_left_px = 0.0;  ///< median of the absolute row error after the correction
    double significance = 0.0;       ///< chi^2 of all three parameters (3 degrees of freedom)

    /// A chi square with 3 degrees of freedom exceeds this by chance once in 1000 cases.
    static constexpr double kSignificant = 16.27;
    [[nodiscard]] bool significant() const noexcept { return significance > kSignificant; }
};

/// Estimates the right camera's rotation (pitch p about x, roll r about z) and the share m by which
/// its focal lengths are too long. To first order, the image of the ray (x, y, 1) moves by
///   rows:    dv / f = p (1 + y^2) - r x + m y
///   columns: du / f = p x y + r y + m x
/// Row errors should be 0. They give p, r and m, and so the error of every disparity. Example: a
/// focal length 0.06 % too long shifts disparities at the border of a ZED's image by 0.2 px. This
/// is 1 cm at 1.5 m. Method: least squares with Huber's weights.
///
/// Rotation about y (yaw) is not estimated. It moves rows by x y, as a decentred lens does, so an
/// error of the lens would become a bias of every depth.
///
/// `corners` come from rectified images of `rig`. Returns nothing with fewer corners than
/// `min_corners`, or when rotation or focal length exceed the limits of `config`.
[[nodiscard]] std::optional<RigSelfCalibration> estimate_self_calibration(
    const SelfCalibrationConfig& config,
    const camera::RectifiedRig& rig,
    std::span<const CornerShift> corners);

}  // namespace surefoot::stereo
