// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/elevation/elevation_cells.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/visibility/ray_endpoints.hpp"
#include "surefoot/elevation/visibility/visibility.hpp"

namespace surefoot::elevation {

/// Visibility clean-up: applies the free-space evidence of a frame to the cells. It removes
/// overhead objects. If configured, it also bounds the height of unknown ground, and removes
/// remembered surfaces in the free space. Every executor gives the same bytes; no allocation after
/// the first frame of a size.
class VisibilityCleanup {
  public:
    explicit VisibilityCleanup(const ElevationConfig& config);

    /// Starts a frame with the camera at `camera_m` in odom.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// Notes ray endpoints in a cell, see `RayEndpoints::set`. `var_m2`: variance of `z_m`.
    void ended(std::size_t cell, float z_m, float var_m2, float bottom_m) noexcept {
        ends_.set(cell, z_m, bottom_m);
        of_cell_[cell] = not_above_m(z_m, var_m2);
    }
    /// Returns the upper bound of a measured height at `visibility.sigmas`. So an uncertain wrong
    /// match far below the floor does not show a drop.
    [[nodiscard]] float not_above_m(float z_m, float var_m2) const noexcept {
        return z_m + sigmas_ * std::sqrt(var_m2);
    }
    /// Call after the last measurement of the frame. Returns the number of removed surfaces.
    std::int64_t apply(std::int64_t time_ns, Executor& executor, ElevationCells& cells);

  private:
    void look_overhead(int block, ElevationCells& cells) const;
    void look_over_unknown(int block, ElevationCells& cells) const;
    /// Collects lines to surfaces on which this frame and an earlier observation agree.
    void collect_lines(std::int64_t time_ns, const ElevationLayers& layers);
    void find_gone(int block, std::int64_t time_ns, ElevationCells& cells);
    /// True if lines of sight passed through a surface at that height.
    [[nodiscard]] bool passed_through(grid::Cell cell, float z_m) const;
    /// True if a recent observation agreed with the cell, or with a neighbour of equal height.
    [[nodiscard]] bool stands_beside(grid::Cell cell,
                                     std::int64_t time_ns,
                                     const ElevationLayers& layers) const;

    VisibilityConfig config_;
    float margin_m_;
    float hangs_m_;  ///< a surface that begins higher than this above the ground hangs over it
    float sigmas_;
    grid::GridGeometry geometry_;
    Eigen::Vector3d camera_m_ = Eigen::Vector3d::Zero();
    RayEndpoints ends_;
    /// Per cell with a ray endpoint: upper bound of its height. After the lines are collected: 1 =
    /// the lines of sight of the frame remove the surface.
    std::vector<float> of_cell_;
    FreeSpaceRays lines_;
};

}  // namespace surefoot::elevation
