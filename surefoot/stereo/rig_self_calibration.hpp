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
    int min_corners = 150;  ///< fewer say nothing
    /// Larger ones are no trim: the rig wants to be calibrated again.
    double max_turn_deg = 0.6;
    double max_focal_share = 0.01;

    void describe(ConfigVisitor& visitor);
};

/// What the rows of a rectified pair say about the right eye.
struct RigSelfCalibration {
    camera::RightCameraCorrection camera;             ///< yaw stays 0
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< of roll, pitch [rad] and focal share
    int corners = 0;
    double row_error_px = 0.0;       ///< median of the absolute value, before
    double row_error_left_px = 0.0;  ///< and what this trim leaves of it
    double significance = 0.0;       ///< chi square of the three parameters together

    /// A chi square of 3 degrees of freedom is above this once in 1000 times by chance.
    static constexpr double kSignificant = 16.27;
    [[nodiscard]] bool significant() const noexcept { return significance > kSignificant; }
};

/// A right eye that is turned by (pitch p, roll r about x, z) and has focal lengths longer by m
/// shows at the ray (x, y, 1), to first order,
///   rows:    dv / f = p (1 + y^2) - r x + m y
///   columns: du / f = p x y + r y + m x
/// The rows ought to be 0: they give p, r and m, and with them the error of every disparity (a
/// focal length that is 0.06 % too long shifts the disparities at the border of a ZED's image by
/// 0.2 px, a centimetre at 1.5 m). Least squares with Huber's weights.
///
/// Turns about y are left alone: rows see them as x y, like a decentred lens, and would turn an
/// error of the lens into a bias of every depth.
///
/// `corners` are those of rectified images of `rig`. Nothing from fewer corners than `min_corners`,
/// or when the turn or the focal length leaves what a trim may do.
[[nodiscard]] std::optional<RigSelfCalibration> estimate_self_calibration(
    const SelfCalibrationConfig& config,
    const camera::RectifiedRig& rig,
    std::span<const CornerShift> corners);

}  // namespace surefoot::stereo
