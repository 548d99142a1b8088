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
    /// A pair whose rms in the joint solution exceeds this many times what its two images show
    /// alone was not taken at one moment (or the rig bent): most of its error is not noise.
    double pair_factor = 1.5;
    int least_pairs = 3;
};

/// What a pair says about the solution.
struct PairFit {
    std::size_t index = 0;  ///< into the views given
    Pose T_left_board;
    CameraFit left;
    CameraFit right;
    double rms_px = 0.0;  ///< both images
};

/// Error of depth that the calibration alone causes, one sigma.
struct DepthError {
    double distance_m = 0.0;
    double sigma_m = 0.0;
};

struct StereoCalibration {
    LensKind kind = LensKind::pinhole5;
    camera::StereoRig rig;  ///< left, right, T_left_right; the rest is not touched
    /// Order: left lens, right lens (parameter_names), T_left_right (translation [m], rotation
    /// [rad]; right perturbation).
    Eigen::MatrixXd covariance;
    double rms_px = 0.0;    ///< both images, as OpenCV defines it
    double sigma_px = 0.0;  ///< noise of a coordinate, degrees of freedom counted
    /// What the covariance is stated for: `sigma_px`, or the disagreement of the views about the
    /// cameras where that is larger (`view_scatter.hpp`).
    double stated_sigma_px = 0.0;
    /// Row difference of the corners after rectification, in pixels of `row_focal_px`, the mean
    /// focal length of the two lenses: what is left of a corner's error stays as large as it was
    /// found. The rectified images of `run` may be larger or smaller, by what their lens model
    /// makes of the corners of the image, where no board need have been: in their pixels a better
    /// model would look worse for being drawn larger.
    double row_rms_px = 0.0;
    double row_focal_px = 0.0;
    double rectified_focal_px = 0.0;  ///< of the images that `camera/rectifier` makes of these
    double disc_radius_m = 0.0;       ///< of the board's circles, as the views show it, or 0
    /// Of a point straight ahead of the rectified left camera at 0.5, 1 and 2 m.
    std::array<DepthError, 3> depth_errors;
    std::vector<PairFit> pairs;          ///< used, ascending
    std::vector<RejectedView> rejected;  ///< ascending
};

/// Two cameras and how they stand to each other, from views at the same moments: left[i] and
/// right[i] are a pair; an empty view means that the board was not found. Each camera is calibrated
/// alone first; pairs whose relative pose does not agree with the others are found, and left out,
/// the worst first; then everything is estimated jointly.
[[nodiscard]] Result<StereoCalibration> calibrate_stereo(const Board& board,
                                                         std::span<const BoardView> left,
                                                         std::span<const BoardView> right,
                                                         ImageSize size,
                                                         LensKind kind,
                                                         const StereoOptions& options = {});

}  // namespace surefoot::calibration
