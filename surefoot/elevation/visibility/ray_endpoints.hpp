// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Where the lines of sight of one frame ended, and so what air they passed through.
///
/// Lines to floor under a table pass below its top: that the floor is seen says nothing about the
/// top. What contradicts a remembered surface is a line through the very place where it is. All
/// lines start at the camera, so that the one through a place is known, and cells along it say
/// whether it ended beyond.
class RayEndpoints {
  public:
    /// Starts a frame seen from a camera at `camera_m` in odom: nothing has been seen.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// A cell was seen: its highest surface, and the face below it down to `bottom_m`, if it is
    /// one. Different cells may be set side by side.
    void set(std::size_t cell, float z_m, float bottom_m) noexcept {
        z_m_[cell] = z_m;
        bottom_m_[cell] = bottom_m;
    }
    /// Height of what was seen in a cell; NaN = nothing.
    [[nodiscard]] float z_m(std::size_t cell) const noexcept { return z_m_[cell]; }
    /// Lines of sight passed both at `low_m` and at `high_m` over the middle of a cell and ended at
    /// something that lies beyond it: there is nothing between. In front of a surface's near edge a
    /// line just below it, and behind its far edge a line just above it, passes; inside neither.
    [[nodiscard]] bool passed_through(grid::Cell cell, float low_m, float high_m) const;

  private:
    [[nodiscard]] bool passed(grid::Cell cell, float z_m) const;

    grid::GridGeometry geometry_;
    Eigen::Vector2f camera_cells_ = Eigen::Vector2f::Zero();  ///< from the corner of the grid
    float camera_z_m_ = 0.0F;
    std::vector<float> z_m_;  ///< per cell: the highest surface
    std::vector<float> bottom_m_;
};

}  // namespace surefoot::elevation
