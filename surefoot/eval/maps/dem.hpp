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

/// Which height of its points a cell takes.
enum class Reduce : std::uint8_t { max, mean, min };

/// Where the cells of a height map lie.
enum class Lattice : std::uint8_t {
    cell,  ///< borders on multiples of the resolution (NOTATION.md): maps of one place fit together
    node,  ///< centres at the smallest x and y and every resolution from there, as CloudCompare's
           ///< RASTERIZE: a point belongs to the nearest centre, the greater one in the middle
};

/// The cells of a height map.
struct DemGrid {
    grid::GridGeometry geometry;
    Lattice lattice = Lattice::cell;
    /// node: the smallest centre [m]; cell: number of the first cell, counted from 0 m.
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
};

/// The cell of a point, ix + iy * nx; `kNoCell` outside, and where a coordinate is not finite.
inline constexpr std::uint32_t kNoCell = 0xffffffffU;
[[nodiscard]] std::uint32_t cell_number(const DemGrid& grid, const Eigen::Vector3d& p_m) noexcept;

/// The box around points that are given in any number of pieces; points with a coordinate that is
/// not finite, or a height beyond kMaxHeight_m, are counted and left out.
class CloudBounds {
  public:
    void add(std::span<const Eigen::Vector3d> points_m, Executor& executor = serial());

    [[nodiscard]] std::int64_t points() const noexcept { return points_; }
    [[nodiscard]] std::int64_t skipped() const noexcept { return skipped_; }

    /// The cells that hold all points. Errors: no point; more cells than a map may have.
    [[nodiscard]] Result<DemGrid> grid(double resolution_m, Lattice lattice) const;

  private:
    void add(const Eigen::Vector3d& p_m);

    Eigen::Vector2d low_m_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m_ = Eigen::Vector2d::Zero();
    std::int64_t points_ = 0;
    std::int64_t skipped_ = 0;
};

/// Heights of points on a grid, in any number of pieces: memory grows with the cells and the
/// threads, not with the points. Each thread has cells of its own. Neither the highest and the
/// lowest nor the mean (sums of whole numbers of 0.12 um) depend on the order of the points or on
/// the number of threads.
class DemBuilder {
  public:
    DemBuilder(const DemGrid& grid, Reduce reduce);

    /// Points outside the grid are left out, and those that CloudBounds leaves out.
    void add(std::span<const Eigen::Vector3d> points_m, Executor& executor = serial());

    /// Heights so far; NaN where no point fell.
    [[nodiscard]] grid::Layer heights_m() const;

  private:
    struct Part {
        std::vector<double> value;  ///< highest, lowest [m] or sum [steps]
        std::vector<std::int64_t> count;
    };
    [[nodiscard]] Part empty() const;
    void join(double value, double& kept) const;

    DemGrid grid_;
    Reduce reduce_;
    std::vector<Part> parts_;
};

}  // namespace surefoot::eval
