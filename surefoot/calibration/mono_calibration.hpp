// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/bundle/camera_fit.hpp"
#include "surefoot/calibration/bundle/robust_bundle.hpp"
#include "surefoot/calibration/bundle/view_selection.hpp"
#include "surefoot/calibration/lenses/lens.hpp"
#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::calibration {

struct CalibrationOptions {
    int least_points = 8;  ///< least number of points of a view; four fix a pose, more check it
    RobustLimits limits;
    SelectionLimits selection;
    /// Largest accepted standard deviation of the focal length, divided by the focal length.
    /// ASSUMPTION: 5 %; the relative depth error is as large.
    double most_focal_sigma = 0.05;
    /// Least accepted angle between the two least parallel boards: parallel boards count as one
    /// (Zhang 2000, section 3.4). ASSUMPTION: 5 deg; messages ask users to tilt by 20 deg and more.
    double least_tilt_deg = 5.0;
};

struct ViewFit {
    std::size_t index = 0;  ///< index into the input views
    Pose T_camera_board;
    CameraFit camera;
};

struct MonoCalibration {
    LensKind kind = LensKind::pinhole5;
    camera::Camera camera;
    Eigen::VectorXd parameters;  ///< ordered as parameter_names(kind); fx to cy in px
    /// Covariance of `parameters`, from the scatter of residuals and views (`stated_sigma_px`).
    Eigen::MatrixXd covariance;
    double rms_px = 0.0;    ///< rms distance of used points from their prediction, as in OpenCV
    double sigma_px = 0.0;  ///< noise of a coordinate, corrected for degrees of freedom
    /// Noise behind the covariance: `sigma_px`, or the scatter of the cameras between views if that
    /// is larger (`view_scatter.hpp`).
    double stated_sigma_px = 0.0;
    double disc_radius_m = 0.0;          ///< circle radius from the views; 0 without circles
    std::vector<ViewFit> views;          ///< views used, ascending
    std::vector<RejectedView> rejected;  ///< views left out, ascending
};

/// Calibrates a camera from views of a flat board. Tries focal lengths (see start_bundle), refines
/// with Huber's loss, removes views and points that do not fit, and ends with least squares.
/// Returns an error if too few views are left or if the views do not determine the camera.
[[nodiscard]] Result<MonoCalibration> calibrate_mono(const Board& board,
                                                     std::span<const BoardView> views,
                                                     ImageSize size,
                                                     LensKind kind,
                                                     const CalibrationOptions& options = {});

}  // namespace surefoot::calibration
