// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::camera {

/// Points of a disparity image as in RectifiedRig::point, but in float. Every processor gives the
/// same bytes, within 4 units in the last place of the exact point.
class Reprojector {
  public:
    explicit Reprojector(const RectifiedRig& rig);

    /// Point [m] of every pixel in the rectified left optical frame. x, y and z are NaN if the
    /// disparity is not a finite number above 0. The image must have the size of the rig.
    void points(ImageView<const float> disparity_px, Image<Eigen::Vector3f>& out) const;

  private:
    float depth_to_disparity_px_m_;
    std::vector<float> ray_x_;  ///< x of the ray of each column, at z = 1
    std::vector<float> ray_y_;  ///< y of the ray of each row, at z = 1
};

}  // namespace surefoot::camera
