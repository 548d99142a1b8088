// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/dem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/height_limit.hpp"
#include "surefoot/core/pieces.hpp"

namespace surefoot::eval {
namespace {

/// Largest number of cells. 2^27 cells need 1 GB for the sums and 1 GB for the counts; a larger map
/// means a wrong unit or resolution.
constexpr double kMostCells = 134217728.0;
/// Largest cell number: whole numbers up to this limit are exact in double.
constexpr double kLargestNumber = 1e15;
/// Steps per metre in sums of heights. Sums of whole steps of 2^-23 m (0.12 um) are exact in double
/// up to 10^9 m.
constexpr double kSteps = 8388608.0;
/// Largest number of cells of all threads together: 1 GB. Larger grids use fewer threads.
constexpr std::size_t kMostPartCells = 1U << 26U;
/// Smallest number of points that justifies a thread.
constexpr std::size_t kPiece = 1U << 14U;

/// Returns true if a height map may hold this point.
bool is_mappable(const Eigen::Vector3d& p_m) {
    return p_m.allFinite() && std::abs(p_m.z()) <= kMaxHeight_m;
}

/// Returns the number of the cell, or of the nearest node, along one axis.
double number_of(double p_m, double low, double resolution_m, Lattice lattice) {
    if (lattice == Lattice::node) return std::floor((p_m - low) / resolution_m + 0.5);
    return std::floor(p_m / resolution_m) - low;
}

}  // namespace

std::uint32_t cell_number(const DemGrid& grid, const Eigen::Vector3d& p_m) noexcept {
    const grid::GridGeometry& geometry = grid.geometry;
    const auto number = [&](int axis) {
        return number_of(p_m[axis], grid.first[axis], geometry.resolution_m, grid.lattice);
    };
    if (!is_mappable(p_m)) return kNoCell;
    const double ix = number(0);
    const double iy = number(1);
    if (!(ix >= 0.0 && iy >= 0.0 && ix < geometry.nx && iy < geometry.ny)) return kNoCell;
    // in range: 0 to nx and ny, as checked
    return static_cast<std::uint32_t>(iy) * static_cast<std::uint32_t>(geometry.nx) +
           static_cast<std::uint32_t>(ix);  // in range
}

void CloudBounds::add(std::span<const Eigen::Vector3d> points_m, Executor& executor) {
    std::vector<CloudBounds> pieces(pieces_of(points_m.size(), kPiece));
    in_pieces(points_m.size(),
              kPiece,
              executor,
              [&](std::size_t begin, std::size_t end, std::size_t piece) {
                  // A local object: an element of `pieces` would share a cache line with another
                  // thread's element.
                  CloudBounds bounds;
                  for (std::size_t i = begin; i < end; ++i) bounds.add(points_m[i]);
                  pieces[piece] = bounds;
              });
    for (const CloudBounds& piece : pieces) {
        skipped_ += piece.skipped_;
        if (piece.points_ == 0) continue;
        if (points_ == 0) low_m_ = high_m_ = piece.low_m_;
        low_m_ = low_m_.cwiseMin(piece.low_m_);
        high_m_ = high_m_.cwiseMax(piece.high_m_);
        points_ += piece.points_;
    }
}

void CloudBounds::add(const Eigen::Vector3d& p_m) {
    if (!is_mappable(p_m)) {
        ++skipped_;
        return;
    }
    if (points_ == 0) low_m_ = high_m_ = p_m.head<2>();
    low_m_ = low_m_.cwiseMin(p_m.head<2>());
    high_m_ = high_m_.cwiseMax(p_m.head<2>());
    ++points_;
}

Result<DemGrid> CloudBounds::grid(double resolution_m, Lattice lattice) const {
    SUREFOOT_ASSERT(resolution_m > 0.0);
    if (points_ == 0) {
        return input_error(
            fmt::format("no point with finite coordinates and a height within +-{:g} m ({} points "
                        "read); check the file and the unit of its heights",
                        kMaxHeight_m,
                        skipped_));
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
        return usage_error(
            fmt::format("points from ({:g}, {:g}) to ({:g}, {:g}) m need {:g} x {:g} cells of {:g} "
                        "m; the limit is {:g} cells: choose larger cells (resolution), or "
                        "remove stray points",
                        low_m_.x(),
                        low_m_.y(),
                        high_m_.x(),
                        high_m_.y(),
                        cells.x(),
                        cells.y(),
                        resolution_m,
                        kMostCells));
    }
    // in range: each is at least 1, and their product at most kMostCells
    geometry.nx = static_cast<int>(cells.x());
    geometry.ny = static_cast<int>(cells.y());  // in range: see the check above
    return grid;
}

DemBuilder::DemBuilder(const DemGrid& grid, Reduce reduce) : grid_(grid), reduce_(reduce) {
    parts_.push_back(empty());
}

DemBuilder::Part DemBuilder::empty() const {
    const auto cells =
        static_cast<std::size_t>(grid_.geometry.nx) * static_cast<std::size_t>(grid_.geometry.ny);
    const double infinity = std::numeric_limits<double>::infinity();
    Part part;
    part.value.assign(cells,
                      reduce_ == Reduce::max   ? -infinity
                      : reduce_ == Reduce::min ? infinity
                                               : 0.0);
    part.count.assign(cells, 0);
    return part;
}

void DemBuilder::join(double value, double& kept) const {
    switch (reduce_) {
        case Reduce::max: kept = std::max(kept, value); break;
        case Reduce::min: kept = std::min(kept, value); break;
        case Reduce::mean: kept += value; break;
    }
}

void DemBuilder::add(std::span<const Eigen::Vector3d> points_m, Executor& executor) {
    const std::size_t cells = parts_.front().count.size();
    const std::size_t most = std::max(kMostPartCells / cells, std::size_t{1});
    const std::size_t parts = std::min(static_cast<std::size_t>(executor.threads()), most);
    while (parts_.size() < parts) parts_.push_back(empty());
    const std::size_t share = pieces_of(points_m.size(), parts);
    if (share == 0) return;
    in_pieces(points_m.size(), share, executor, [&](std::size_t begin, std::size_t end, auto i) {
        for (const Eigen::Vector3d& p_m : points_m.subspan(begin, end - begin)) {
            const std::uint32_t cell = cell_number(grid_, p_m);
            if (cell == kNoCell) continue;
            const double z_m = p_m.z();
            join(reduce_ == Reduce::mean ? std::round(kSteps * z_m) : z_m, parts_[i].value[cell]);
            ++parts_[i].count[cell];
        }
    });
}

grid::Layer DemBuilder::heights_m() const {
    grid::Layer heights_m(
        grid_.geometry.nx, grid_.geometry.ny, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
        double value = parts_.front().value[i];
        std::int64_t count = parts_.front().count[i];
        for (const Part& part : std::span(parts_).subspan(1)) {
            join(part.value[i], value);
            count += part.count[i];
        }
        if (count == 0) continue;
        const double divisor = reduce_ == Reduce::mean ? kSteps * static_cast<double>(count) : 1.0;
        heights_m.data()[i] = static_cast<float>(value / divisor);
    }
    return heights_m;
}

}  // namespace surefoot::eval
