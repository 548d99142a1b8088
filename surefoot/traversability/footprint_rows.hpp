// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/cell_run.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::traversability::rows {

/// What one layer holds in cells that were added run by run; values that are not finite are
/// unknown. Cell i of a run goes to lane i mod kLanes, whatever the registers' width, so that the
/// sum has the same bytes for every instruction set.
struct LaneStatistics {
    static constexpr int kLanes = 8;

    LaneStatistics() noexcept;
    /// Joins the lanes, in a fixed order.
    [[nodiscard]] double joined_sum() const noexcept;
    [[nodiscard]] float joined_min() const noexcept;  ///< +infinity without a known value
    [[nodiscard]] float joined_max() const noexcept;  ///< -infinity without one

    alignas(64) double sum[kLanes] = {};
    alignas(32) float min[kLanes] = {};
    alignas(32) float max[kLanes] = {};
    std::int64_t known = 0;
};

/// Adds the cells of runs that lie within the layer. Returns which run was the first to hold the
/// smallest value so far, or -1 where an earlier call met one as small.
std::int64_t add_runs(ImageView<const float> layer,
                      std::span<const grid::CellRun> runs,
                      LaneStatistics& statistics) noexcept;

}  // namespace surefoot::traversability::rows
