// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "surefoot/grid/cell_run.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// Cells of a grid that a grown convex hull overlaps. The hull of a few points is grown by a radius
/// on all sides: one point gives a circle, two a swept circle, more a rounded polygon. The cells of
/// a row form one run, because the area is convex.
///
/// A cell counts if it overlaps by at least `kSliver_cells` in x and in y. Otherwise rounding would
/// decide whether a foot that ends on a cell border covers one more row. Uses doubles, for reports
/// and pictures only; the gate decides with fixed_polygon.hpp.
class ConvexArea {
  public:
    static constexpr int kMaxPoints = 32;
    static constexpr double kSliver_cells = 1e-5;
    /// Largest coordinate of an area. Up to here, rounding stays far below `kSliver_cells`.
    static constexpr double kMaxReach_cells = 1 << 20;

    /// The area is empty (no rows) without points, with more than kMaxPoints or with a negative
    /// radius. It is also empty if a value is not finite or the area lies beyond kMaxReach_cells.
    ConvexArea(std::span<const Eigen::Vector2d> points_m,
               double radius_m,
               const GridGeometry& geometry) noexcept;

    [[nodiscard]] bool empty() const noexcept { return first_row_ >= end_row_; }
    [[nodiscard]] std::int64_t first_row() const noexcept { return first_row_; }
    [[nodiscard]] std::int64_t end_row() const noexcept { return end_row_; }
    /// Returns the overlapped cells of a row in [first_row, end_row): at least one cell. The run
    /// may extend beyond the grid. Cost: proportional to the number of points.
    [[nodiscard]] CellRun row(std::int64_t iy) const noexcept;

  private:
    /// An edge of the hull, moved outward by the radius: x as a function of y [cells].
    struct Edge {
        double low = 0.0;
        double high = 0.0;
        double x_at_low = 0.0;
        double x_per_y = 0.0;
    };

    using Points = std::array<Eigen::Vector2d, 2 * kMaxPoints>;

    void take_hull(Points& points, int count) noexcept;
    void take_edges() noexcept;
    void take_rows() noexcept;
    [[nodiscard]] double rim_x(const Edge* edges, int count, double side, double y) const noexcept;

    std::array<Eigen::Vector2d, kMaxPoints> hull_;  ///< corners, counter-clockwise [cells]
    std::array<Edge, kMaxPoints> right_;            ///< edges that go up
    std::array<Edge, kMaxPoints> left_;             ///< edges that go down
    int hull_count_ = 0;
    int right_count_ = 0;
    int left_count_ = 0;
    double radius_ = 0.0;       ///< radius of the area [cells]
    double rightmost_y_ = 0.0;  ///< y of the point that lies farthest to the right
    double leftmost_y_ = 0.0;
    std::int64_t first_row_ = 0;
    std::int64_t end_row_ = 0;
};

}  // namespace surefoot::grid
