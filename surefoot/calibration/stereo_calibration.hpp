// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surefoot/calibration/mono_calibration.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::calibration {

struct StereoOptions {
    CalibrationOptions camera;
    /// Limit of a pair's joint rms, divided by the rms of its images alone (or by the median over
    /// all pairs, if larger). Above it, the images mostly differ in time or the rig bent.
    double pair_factor = 1.5;
    int least_pairs = 3;
};

/// Residuals of one pair in the solution.
struct PairFit {
    std::size_t index = 0;  ///< index into the input views
    Pose T_left_board;
    CameraFit left;
    CameraFit right;
    double rms_px = 0.0;  ///< rms over both images
};

/// Depth error (one sigma) from the calibration alone.
struct DepthError {
    double distance_m = 0.0;
    double sigma_m = 0.0;
};

struct StereoCalibration {
    LensKind kind = LensKind::pinhole5;
    camera::StereoRig rig;  ///< only left, right and T_left_right are set
    /// Order: left lens, right lens (parameter_names), T_left_right (translation [m], rotation
    /// [rad]; right perturbation).
    Eigen::MatrixXd covariance;
    double rms_px = 0.0;    ///< rms over both images, as in OpenCV
    double sigma_px = 0.0;  ///< noise of a coordinate, corrected for degrees of freedom
    /// Noise behind the covariance: `sigma_px`, or the scatter of the cameras between views if that
    /// is larger (`view_scatter.hpp`).
    double stated_sigma_px = 0.0;
    /// Rms row difference of the corners after rectification, for images of focal length
    /// `row_focal_px` (the mean of the two lenses). In this unit a corner error is as large as in
    /// the raw image. The rectified images of `surefoot run` may be larger or smaller. The lens
    /// model sets their size at the image corners, where perhaps no board was seen. In their pixels
    /// a better model with larger images would seem worse.
    double row_rms_px = 0.0;
    double row_focal_px = 0.0;
    double rectified_focal_px = 0.0;  ///< focal length of images from `camera/rectifier`
    double disc_radius_m = 0.0;       ///< circle radius from the views; 0 without circles
    /// Depth errors of a point straight ahead of the rectified left camera at 0.5, 1 and 2 m.
    std::array<DepthError, 3> depth_errors;
    std::vector<PairFit> pairs;          ///< pairs used, ascending
    std::vector<RejectedView> rejected;  ///< pairs left out, ascending
};

/// Calibrates two cameras and their relative pose from simultaneous views: left[i] and right[i] are
/// a pair. An empty view means that the board was not found. First calibrates each camera alone.
/// Then removes pairs whose relative pose is far from the median pose. Finally estimates all
/// parameters jointly and removes bad pairs, worst first.
[[nodiscard]] Result<StereoCalibration> calibrate_stereo(const Board& board,
                                                         std::span<const BoardView> left,
                                                         std::span<const BoardView> right,
                                                         ImageSize size,
                                                         LensKind kind,
                                                         const StereoOptions& options = {});

}  // namespace surefoot::calibration
