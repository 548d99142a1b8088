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

/// What a frame's lines of sight say of the cells: which things overhead are gone, how deep unknown
/// ground lies below them, and (if so configured) which remembered surfaces stand in their way,
/// which are forgotten. Same bytes for every executor; no allocation after the first frame of a
/// size.
class VisibilityCleanup {
  public:
    explicit VisibilityCleanup(const ElevationConfig& config);

    /// Starts a frame seen from a camera at `camera_m` in odom.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// Lines of sight ended in a cell, see `RayEndpoints::set`, as surely as `var_m2` says.
    void ended(std::size_t cell, float z_m, float var_m2, float bottom_m) noexcept {
        ends_.set(cell, z_m, bottom_m);
        of_cell_[cell] = not_above_m(z_m, var_m2);
    }
    /// So low what was seen at that height is, at `visibility.sigmas`, at least: a wrong match far
    /// below the floor, of which the matcher is not sure, shows no drop.
    [[nodiscard]] float not_above_m(float z_m, float var_m2) const noexcept {
        return z_m + sigmas_ * std::sqrt(var_m2);
    }
    /// Call once all of the frame's measurements are in the cells. Returns how many were forgotten.
    std::int64_t apply(std::int64_t time_ns, Executor& executor, ElevationCells& cells);

  private:
    void look_overhead(int block, ElevationCells& cells) const;
    void look_over_unknown(int block, ElevationCells& cells) const;
    /// Of the surfaces that the frame's look, and one before it, saw alike.
    void collect_lines(std::int64_t time_ns, const ElevationLayers& layers);
    void find_gone(int block, std::int64_t time_ns, ElevationCells& cells);
    /// Lines of sight passed through a surface at that height.
    [[nodiscard]] bool passed_through(grid::Cell cell, float z_m) const;
    /// A look agreed with the height of the cell, or of one beside it that is as high, just now.
    [[nodiscard]] bool stands_beside(grid::Cell cell,
                                     std::int64_t time_ns,
                                     const ElevationLayers& layers) const;

    VisibilityConfig config_;
    float margin_m_;
    float hangs_m_;  ///< what is so far over the ground hangs
    float sigmas_;
    grid::GridGeometry geometry_;
    Eigen::Vector3d camera_m_ = Eigen::Vector3d::Zero();
    RayEndpoints ends_;
    /// Per cell with an end: not higher than this. Once the lines are collected: 1 = the frame's
    /// lines of sight say that its surface is gone.
    std::vector<float> of_cell_;
    FreeSpaceRays lines_;
};

}  // namespace surefoot::elevation
