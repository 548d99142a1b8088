// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Number of pixels that level ground in a cell covers. A cell has the area A, the distance r, the
/// depth z along the optical axis, and lies h below the camera. It covers the solid angle
/// A h / r^3, and a pixel covers (z / r)^3 / (fx fy). So the number is
///   n = A fx fy h / z^3.
/// A vertical surface shows more pixels (Oniga and Nedevschi 2010 use this to detect obstacles).
class ExpectedPoints {
  public:
    ExpectedPoints(const camera::RectifiedRig& rig,
                   const Pose& T_odom_body,
                   const grid::GridGeometry& geometry);

    /// Returns the number for ground at `z_m` in odom; 0 behind or above the camera.
    [[nodiscard]] float at(int ix, int iy, float z_m) const noexcept {
        const float x = x_m_ + resolution_m_ * static_cast<float>(ix);
        const float y = y_m_ + resolution_m_ * static_cast<float>(iy);
        const float below_m = camera_z_m_ - z_m;
        const float depth_m = axis_x_ * x + axis_y_ * y - axis_z_ * below_m;
        if (!(below_m > 0.0F && depth_m > 0.0F)) return 0.0F;
        return scale_m2_ * below_m / (depth_m * depth_m * depth_m);
    }
    /// True if the whole cell, with its middle at `z_m` in odom, lies in both images (the test uses
    /// the ball around the cell).
    [[nodiscard]] bool is_whole_in_view(int ix, int iy, float z_m) const noexcept {
        const float x = x_m_ + resolution_m_ * static_cast<float>(ix);
        const float y = y_m_ + resolution_m_ * static_cast<float>(iy);
        const float z = z_m - camera_z_m_;
        bool whole = true;
        for (const Side& side : sides_)
            whole &= side.x * x + side.y * y + side.z * z + side.offset_m >= 0.0F;
        return whole;
    }

  private:
    float scale_m2_;  ///< A fx fy
    float x_m_;       ///< position of cell (0, 0) from the camera
    float y_m_;
    float camera_z_m_;
    float resolution_m_;
    float axis_x_;  ///< optical axis in odom
    float axis_y_;
    float axis_z_;
    /// One side of the common view of both cameras, moved inwards by the radius of a cell. A point
    /// p (from the camera, in odom axes) is inside if (x, y, z) . p + offset >= 0.
    struct Side {
        float x;
        float y;
        float z;
        float offset_m;
    };
    std::array<Side, 5> sides_{};
};

}  // namespace surefoot::elevation
