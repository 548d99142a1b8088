// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Ray endpoints of one frame: the surfaces at which its lines of sight ended. They tell which
/// space is free.
///
/// Lines to the floor under a table pass below the top, so an observed floor does not contradict
/// the top. Only a line through the remembered top contradicts it. All lines start at the camera,
/// so the line through a position is known. The cells along the line show if it ended farther away.
class RayEndpoints {
  public:
    /// Starts a frame with the camera at `camera_m` in odom, without any observed cell.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// Sets the observed surface of a cell: its height, and for a face its lower end `bottom_m`.
    /// Threads may set different cells at the same time.
    void set(std::size_t cell, float z_m, float bottom_m) noexcept {
        z_m_[cell] = z_m;
        bottom_m_[cell] = bottom_m;
    }
    /// Returns the observed height of a cell; NaN = not observed.
    [[nodiscard]] float z_m(std::size_t cell) const noexcept { return z_m_[cell]; }
    /// True if lines of sight passed at `low_m` and at `high_m` over the middle of a cell and ended
    /// beyond it. Then the space between is free. In front of a surface's near edge only the lower
    /// line passes, behind its far edge only the upper one; inside the surface neither passes.
    [[nodiscard]] bool passed_through(grid::Cell cell, float low_m, float high_m) const;

  private:
    [[nodiscard]] bool passed(grid::Cell cell, float z_m) const;

    grid::GridGeometry geometry_;
    Eigen::Vector2f camera_cells_ = Eigen::Vector2f::Zero();  ///< position from the corner [cells]
    float camera_z_m_ = 0.0F;
    std::vector<float> z_m_;  ///< highest surface of each cell
    std::vector<float> bottom_m_;
};

}  // namespace surefoot::elevation
