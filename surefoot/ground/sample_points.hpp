// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/depth_image.hpp"

namespace surefoot::ground {

/// What one frame of a depth camera saw, in base_link.
struct FramePoints {
    Eigen::Vector3d camera_body_m = Eigen::Vector3d::Zero();  ///< optical centre
    std::vector<Eigen::Vector3d> points_body_m;
    /// One sigma [1/m] of the inverse of the distance between each point and the camera. In it the
    /// disparity's noise is linear, and so is a plane (`refine_plane`).
    std::vector<double> inverse_range_sigma;
    std::size_t pixels = 0;  ///< looked at, with and without depth
    /// What an imperfect calibration does to every plane alike: covariance of m = -n / h
    /// (`refine_plane`) [1/m^2]. An error of all disparities that grows by the place in the image
    /// adds a constant to m.
    Eigen::Matrix3d calibration_covariance = Eigen::Matrix3d::Zero();
};

/// Replaces `seen` by every `step_px`-th pixel of every `step_px`-th row whose disparity and its
/// sigma are known and whose outlier probability is at most `max_outlier_probability`.
void sample_points(const camera::RectifiedRig& rig,
                   const DepthImage& depth,
                   int step_px,
                   FramePoints& seen,
                   float max_outlier_probability = 0.2F);

}  // namespace surefoot::ground
