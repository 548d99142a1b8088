// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/depth_image.hpp"

namespace surefoot::ground {

/// Points that a depth camera measured in one frame, in base_link.
struct FramePoints {
    Eigen::Vector3d camera_body_m = Eigen::Vector3d::Zero();  ///< optical centre
    std::vector<Eigen::Vector3d> points_body_m;
    /// One sigma [1/m] of the inverse distance between each point and the camera. Disparity noise
    /// and planes are both linear in the inverse distance (`refine_plane`).
    std::vector<double> inverse_range_sigma;
    std::size_t pixels = 0;  ///< number of pixels examined, with and without depth
    /// Effect of an imperfect calibration on every plane alike: covariance of m = -n / h
    /// (`refine_plane`) [1/m^2]. A disparity error that is linear in the pixel position adds a
    /// constant to m.
    Eigen::Matrix3d calibration_covariance = Eigen::Matrix3d::Zero();
};

/// Replaces `seen` by the points of every `step_px`-th pixel and row, if the pixel has a known
/// disparity and sigma and an outlier probability of at most `max_outlier_probability`.
void sample_points(const camera::RectifiedRig& rig,
                   const DepthImage& depth,
                   int step_px,
                   FramePoints& seen,
                   float max_outlier_probability = 0.1F);

}  // namespace surefoot::ground
