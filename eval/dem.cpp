// SPDX-License-Identifier: Apache-2.0
#include "eval/dem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"

namespace surefoot::eval {
namespace {

/// 2^27 cells are 1 GB of sums and counts twice over: a wrong unit or resolution, not a map.
constexpr double kMostCells = 134217728.0;
/// Whole numbers up to here are exact in double, and fit an int after the first is subtracted.
constexpr double kLargestNumber = 1e15;

/// Number of the cell, or of the nearest node, along one axis.
double number_of(double p_m, double low, double resolution_m, Lattice lattice) {
    if (lattice == Lattice::node) return std::floor((p_m - low) / resolution_m + 0.5);
    return std::floor(p_m / resolution_m) - low;
}

}  // namespace

void CloudBounds::add(std::span<const Eigen::Vector3d> points_m) {
    for (const Eigen::Vector3d& p_m : points_m) {
        if (!p_m.allFinite()) {
            ++skipped_;
            continue;
        }
        if (points_ == 0) low_m_ = high_m_ = p_m.head<2>();
        low_m_ = low_m_.cwiseMin(p_m.head<2>());
        high_m_ = high_m_.cwiseMax(p_m.head<2>());
        ++points_;
    }
}

Result<DemGrid> CloudBounds::grid(double resolution_m, Lattice lattice) const {
    SUREFOOT_ASSERT(resolution_m > 0.0);
    if (points_ == 0) {
        return input_error(fmt::format(
            "no point with finite coordinates among {}: there is nothing to map", skipped_));
    }
    Eigen::Vector2d cells;
    DemGrid grid;
    grid.lattice = lattice;
    grid::GridGeometry& geometry = grid.geometry;
    geometry.resolution_m = resolution_m;
    for (int axis = 0; axis < 2; ++axis) {
        const bool node = lattice == Lattice::node;
        const double low = node ? low_m_[axis] : std::floor(low_m_[axis] / resolution_m);
        grid.first[axis] = low;
        cells[axis] = number_of(high_m_[axis], low, resolution_m, lattice) + 1.0;
        geometry.origin_m[axis] = node ? low - 0.5 * resolution_m : low * resolution_m;
        const bool exact = std::abs(low_m_[axis]) / resolution_m < kLargestNumber &&
                           std::abs(high_m_[axis]) / resolution_m < kLargestNumber;
        if (!exact) cells[axis] = std::numeric_limits<double>::infinity();
    }
    if (!(cells.x() * cells.y() <= kMostCells)) {
        return usage_error(fmt::format(
            "points from ({:g}, {:g}) to ({:g}, {:g}) m need {:g} x {:g} cells of {:g} m, more "
            "than {:g}: choose a larger resolution, or remove stray points",
            low_m_.x(),
            low_m_.y(),
            high_m_.x(),
            high_m_.y(),
            cells.x(),
            cells.y(),
            resolution_m,
            kMostCells));
    }
    geometry.nx = static_cast<int>(cells.x());
    geometry.ny = static_cast<int>(cells.y());
    return grid;
}

DemBuilder::DemBuilder(const DemGrid& grid, Reduce reduce) : grid_(grid), reduce_(reduce) {
    const auto cells =
        static_cast<std::size_t>(grid.geometry.nx) * static_cast<std::size_t>(grid.geometry.ny);
    const double infinity = std::numeric_limits<double>::infinity();
    value_m_.assign(cells,
                    reduce == Reduce::max   ? -infinity
                    : reduce == Reduce::min ? infinity
                                            : 0.0);
    count_.assign(cells, 0);
}

void DemBuilder::add(std::span<const Eigen::Vector3d> points_m) {
    const grid::GridGeometry& geometry = grid_.geometry;
    const auto number = [&](const Eigen::Vector3d& p_m, int axis) {
        return number_of(p_m[axis], grid_.first[axis], geometry.resolution_m, grid_.lattice);
    };
    for (const Eigen::Vector3d& p_m : points_m) {
        if (!p_m.allFinite()) continue;
        const double ix = number(p_m, 0);
        const double iy = number(p_m, 1);
        if (!(ix >= 0.0 && iy >= 0.0 && ix < geometry.nx && iy < geometry.ny)) continue;
        const std::size_t cell =
            static_cast<std::size_t>(iy) * static_cast<std::size_t>(geometry.nx) +
            static_cast<std::size_t>(ix);
        double& value_m = value_m_[cell];
        switch (reduce_) {
            case Reduce::max: value_m = std::max(value_m, p_m.z()); break;
            case Reduce::min: value_m = std::min(value_m, p_m.z()); break;
            case Reduce::mean: value_m += p_m.z(); break;
        }
        ++count_[cell];
    }
}

grid::Layer DemBuilder::heights_m() const {
    grid::Layer heights_m(
        grid_.geometry.nx, grid_.geometry.ny, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < count_.size(); ++i) {
        if (count_[i] == 0) continue;
        const double divisor = reduce_ == Reduce::mean ? static_cast<double>(count_[i]) : 1.0;
        heights_m.data()[i] = static_cast<float>(value_m_[i] / divisor);
    }
    return heights_m;
}

}  // namespace surefoot::eval
