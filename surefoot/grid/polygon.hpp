// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Simple polygon (no edge crosses another) in the plane of a grid, either direction of travel.
/// The gate decides with the exact integer twin in fixed_polygon.hpp; this one serves everything
/// that only describes. A point on the boundary belongs to exactly one of two polygons that share
/// it.
class Polygon {
  public:
    Polygon() = default;
    explicit Polygon(std::vector<Eigen::Vector2d> vertices_m);

    [[nodiscard]] const std::vector<Eigen::Vector2d>& vertices_m() const noexcept {
        return vertices_m_;
    }
    /// Less than three vertices or a coordinate that is not finite: contains nothing.
    [[nodiscard]] bool empty() const noexcept { return vertices_m_.size() < 3; }
    /// Even-odd rule with half-open edges; false for NaN.
    [[nodiscard]] bool contains(double x_m, double y_m) const noexcept;

  private:
    std::vector<Eigen::Vector2d> vertices_m_;
};

/// Calls `visit` for each cell of the grid whose centre the polygon contains, rows from the
/// smallest y, and returns how many more such cells would lie outside the grid. Cost: rows times
/// edges plus the cells inside. For the cells that a convex shape overlaps: convex_area.hpp.
std::int64_t cells_in(const Polygon& polygon,
                      const GridGeometry& geometry,
                      const std::function<void(Cell)>& visit);

/// What a layer holds under a polygon, found in one pass. Unknown is NaN.
struct LayerSummary {
    std::int64_t known = 0;
    std::int64_t unknown = 0;                               ///< in the grid without a value
    std::int64_t outside = 0;                               ///< beyond the grid: unknown too
    double min = std::numeric_limits<double>::quiet_NaN();  ///< of the known cells
    double max = std::numeric_limits<double>::quiet_NaN();
    double mean = std::numeric_limits<double>::quiet_NaN();

    [[nodiscard]] bool all_known() const noexcept {
        return known > 0 && unknown == 0 && outside == 0;
    }
};

[[nodiscard]] LayerSummary summarise(const Polygon& polygon,
                                     const GridGeometry& geometry,
                                     ImageView<const float> layer);

}  // namespace surefoot::grid
