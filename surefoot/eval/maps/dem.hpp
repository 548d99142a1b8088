// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

/// Rule by which a cell combines the heights of its points.
enum class Reduce : std::uint8_t { max, mean, min };

/// Alignment of the cells of a height map.
enum class Lattice : std::uint8_t {
    cell,  ///< borders at multiples of the resolution (NOTATION.md), so maps align
    node,  ///< first centre at the smallest x and y (CloudCompare: RASTERIZE); a point belongs to
           ///< the nearest centre, at equal distance to the one with the greater coordinate
};

/// The cells of a height map.
struct DemGrid {
    grid::GridGeometry geometry;
    Lattice lattice = Lattice::cell;
    /// node: smallest centre [m]; cell: number of the first cell, counted from coordinate 0.
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
};

/// Cell index ix + iy * nx of a point; `kNoCell` outside, and for points that CloudBounds skips.
inline constexpr std::uint32_t kNoCell = 0xffffffffU;
[[nodiscard]] std::uint32_t cell_number(const DemGrid& grid, const Eigen::Vector3d& p_m) noexcept;

/// Bounding box of points that are added in any number of pieces. Points that are not finite and
/// points with a height beyond kMaxHeight_m are counted and left out.
class CloudBounds {
  public:
    void add(std::span<const Eigen::Vector3d> points_m, Executor& executor = serial());

    [[nodiscard]] std::int64_t points() const noexcept { return points_; }
    [[nodiscard]] std::int64_t skipped() const noexcept { return skipped_; }

    /// Returns the cells that contain all points. Errors: no point; too many cells for a map.
    [[nodiscard]] Result<DemGrid> grid(double resolution_m, Lattice lattice) const;

  private:
    void add(const Eigen::Vector3d& p_m);

    Eigen::Vector2d low_m_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m_ = Eigen::Vector2d::Zero();
    std::int64_t points_ = 0;
    std::int64_t skipped_ = 0;
};

/// Builds a height map from points in any number of pieces. Memory depends on the number of cells
/// and threads, not on the points: each thread has its own cells. The result does not depend on the
/// order of the points or the number of threads. This also holds for the mean, which sums multiples
/// of 0.12 um.
class DemBuilder {
  public:
    DemBuilder(const DemGrid& grid, Reduce reduce);

    /// Leaves out points outside the grid and points that CloudBounds leaves out.
    void add(std::span<const Eigen::Vector3d> points_m, Executor& executor = serial());

    /// Returns the heights of the points added so far [m]; NaN in cells without a point.
    [[nodiscard]] grid::Layer heights_m() const;

  private:
    struct Part {
        std::vector<double> value;  ///< per cell: highest or lowest height [m], or sum [steps]
        std::vector<std::int64_t> count;
    };
    [[nodiscard]] Part empty() const;
    void join(double value, double& kept) const;

    DemGrid grid_;
    Reduce reduce_;
    std::vector<Part> parts_;
};

}  // namespace surefoot::eval
