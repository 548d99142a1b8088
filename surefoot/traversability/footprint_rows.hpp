// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/cell_run.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::traversability::rows {

/// Statistics of one layer over cells that are added run by run; values that are not finite are
/// unknown. Cell i of a run goes to lane i mod kLanes, whatever the register width, so every
/// instruction set gives the same bytes of the sum.
struct LaneStatistics {
    static constexpr int kLanes = 8;

    LaneStatistics() noexcept;
    /// Adds the lanes, in a fixed order.
    [[nodiscard]] double joined_sum() const noexcept;
    [[nodiscard]] float joined_min() const noexcept;  ///< +infinity without a known value
    [[nodiscard]] float joined_max() const noexcept;  ///< -infinity without a known value

    alignas(64) double sum[kLanes] = {};
    alignas(32) float min[kLanes] = {};
    alignas(32) float max[kLanes] = {};
    std::int64_t known = 0;
};

/// Adds the cells of runs that lie within the layer. Returns the index of the first run with the
/// smallest value so far, or -1 if an earlier call had a value at least as small.
std::int64_t add_runs(ImageView<const float> layer,
                      std::span<const grid::CellRun> runs,
                      LaneStatistics& statistics) noexcept;

}  // namespace surefoot::traversability::rows
