// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/camera/depth_image.hpp"
#include "surefoot/camera/stereo_rig.hpp"

namespace surefoot::ground {

/// Replaces `points_body` by the points in base_link of every `step_px`-th pixel of every
/// `step_px`-th row whose disparity is known and whose outlier probability is at most
/// `max_outlier_probability`.
void sample_points(const camera::RectifiedRig& rig,
                   const camera::DepthImage& depth,
                   int step_px,
                   std::vector<Eigen::Vector3d>& points_body,
                   float max_outlier_probability = 0.2F);

}  // namespace surefoot::ground
