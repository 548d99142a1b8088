// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/elevation/elevation_cells.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/sight_ends.hpp"
#include "surefoot/elevation/visibility.hpp"

namespace surefoot::elevation {

/// What a frame's lines of sight say of the cells: which things overhead are gone, how deep unknown
/// ground lies below them, and (if so configured) which remembered surfaces stand in their way,
/// which are forgotten. Same bytes for every executor; no allocation after the first frame of a
/// size.
class SightCheck {
  public:
    explicit SightCheck(const ElevationConfig& config);

    /// Starts a frame seen from a camera at `camera_m` in odom.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// Lines of sight ended in a cell, see `SightEnds::set`.
    void ended(std::size_t cell, float z_m, float bottom_m) noexcept {
        ends_.set(cell, z_m, bottom_m);
    }
    /// Call once all of the frame's measurements are in the cells. Returns how many were forgotten.
    std::int64_t apply(std::int64_t time_ns, Executor& executor, ElevationCells& cells);

  private:
    void look_overhead(int block, ElevationCells& cells) const;
    void look_over_unknown(int block, ElevationCells& cells) const;
    void collect_lines();
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
    grid::GridGeometry geometry_;
    Eigen::Vector3d camera_m_ = Eigen::Vector3d::Zero();
    SightEnds ends_;
    LinesOfSight lines_;
    std::vector<std::uint8_t> gone_;  ///< per cell: the frame's lines of sight say so
};

}  // namespace surefoot::elevation
