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
    int least_points = 8;  ///< per view; a pose takes four, the rest checks it
    RobustLimits limits;
    SelectionLimits selection;
    /// Largest standard deviation of the focal length over itself that is let through. ASSUMPTION:
    /// 5 %; depth is wrong by as much.
    double most_focal_sigma = 0.05;
    /// Between the two boards that differ most. Parallel boards tell a pinhole camera no more than
    /// one (Zhang 2000, section 3.4). ASSUMPTION: 5 deg; users are told to tilt by 20 and more.
    double least_tilt_deg = 5.0;
};

struct ViewFit {
    std::size_t index = 0;  ///< into the views given
    Pose T_camera_board;
    CameraFit camera;
};

struct MonoCalibration {
    LensKind kind = LensKind::pinhole5;
    camera::Camera camera;
    Eigen::VectorXd parameters;  ///< order of parameter_names(kind), pixels
    /// Of `parameters`, from the scatter of the residuals and of the views (`stated_sigma_px`).
    Eigen::MatrixXd covariance;
    double rms_px = 0.0;    ///< root of the mean squared distance of the points used, as in OpenCV
    double sigma_px = 0.0;  ///< noise of a coordinate, degrees of freedom counted
    /// What the covariance is stated for: `sigma_px`, or the disagreement of the views about the
    /// cameras where that is larger (`view_scatter.hpp`).
    double stated_sigma_px = 0.0;
    double disc_radius_m = 0.0;          ///< of the board's circles, as the views show it, or 0
    std::vector<ViewFit> views;          ///< used, ascending
    std::vector<RejectedView> rejected;  ///< ascending
};

/// A camera from views of a flat board. Starts by trying focal lengths (see start_bundle), refines
/// with Huber's loss, leaves out views and points that do not belong, and ends with least squares.
/// Fails with a sentence when too little is left or the views do not determine the camera.
[[nodiscard]] Result<MonoCalibration> calibrate_mono(const Board& board,
                                                     std::span<const BoardView> views,
                                                     ImageSize size,
                                                     LensKind kind,
                                                     const CalibrationOptions& options = {});

}  // namespace surefoot::calibration
