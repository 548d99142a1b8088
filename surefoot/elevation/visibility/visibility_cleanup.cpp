// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/visibility_cleanup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/time.hpp"
#include "surefoot/elevation/cell_row_blocks.hpp"

namespace surefoot::elevation {
namespace {

constexpr int kBeside = 2;  ///< largest distance [cells] of neighbours that confirm a cell

}  // namespace

VisibilityCleanup::VisibilityCleanup(const ElevationConfig& config)
    : config_(config.visibility),
      margin_m_(static_cast<float>(config.visibility.margin_m)),
      hangs_m_(static_cast<float>(config.min_overhead_m)),
      sigmas_(static_cast<float>(config.visibility.sigmas)) {}

void VisibilityCleanup::reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m) {
    geometry_ = geometry;
    camera_m_ = camera_m;
    ends_.reset(geometry, camera_m);
    of_cell_.resize(static_cast<std::size_t>(geometry.nx) * static_cast<std::size_t>(geometry.ny));
}

std::int64_t VisibilityCleanup::apply(std::int64_t time_ns,
                                      Executor& executor,
                                      ElevationCells& cells) {
    // The closure holds one reference only, so std::function allocates no memory.
    struct Job {
        VisibilityCleanup& check;
        ElevationCells& cells;
        std::int64_t time_ns;
    } job{*this, cells, time_ns};
    const int blocks = RowBlocks(geometry_).count();
    executor.parallel_for(blocks, [&job](int block) { job.check.look_overhead(block, job.cells); });
    if (!config_.drops && !config_.cleanup) return 0;
    collect_lines(time_ns, cells.layers());
    if (config_.drops) {
        executor.parallel_for(blocks,
                              [&job](int block) { job.check.look_over_unknown(block, job.cells); });
    }
    if (!config_.cleanup) return 0;
    std::fill(of_cell_.begin(), of_cell_.end(), 0.0F);
    executor.parallel_for(
        blocks, [&job](int block) { job.check.find_gone(block, job.time_ns, job.cells); });
    // Remove the cells only after all checks, because neighbours confirm each other.
    std::int64_t forgotten = 0;
    for (std::size_t cell = 0; cell < of_cell_.size(); ++cell) {
        if (of_cell_[cell] == 0.0F) continue;
        cells.forget(cell);
        ++forgotten;
    }
    return forgotten;
}

void VisibilityCleanup::look_overhead(int block, ElevationCells& cells) const {
    RowBlocks(geometry_).for_each_cell(block, [&](grid::Cell at, std::size_t cell) {
        const float overhead_m = cells.overhead_m(cell);
        if (std::isnan(overhead_m) || !passed_through(at, overhead_m)) return;
        cells.see_no_more_above(cell);
    });
}

void VisibilityCleanup::collect_lines(std::int64_t time_ns, const ElevationLayers& layers) {
    lines_.reset(geometry_, camera_m_);
    std::size_t cell = 0;
    for (int iy = 0; iy < geometry_.ny; ++iy) {
        for (int ix = 0; ix < geometry_.nx; ++ix, ++cell) {
            if (std::isnan(ends_.z_m(cell))) continue;
            // One wrong match far below the floor would turn all ground before it into a drop. So
            // an endpoint counts only if two observations agree.
            const bool is_agreed =
                layers.seen_ns.data()[cell] == time_ns && layers.count.data()[cell] > 1;
            if (is_agreed) lines_.add({ix, iy}, of_cell_[cell]);
        }
    }
    lines_.finish();
}

void VisibilityCleanup::look_over_unknown(int block, ElevationCells& cells) const {
    const float* height_m = cells.layers().height_m.data();
    RowBlocks(geometry_).for_each_cell(block, [&](grid::Cell at, std::size_t cell) {
        if (!std::isnan(height_m[cell])) return;
        const float line_z_m = lines_.lowest_over(at);
        if (line_z_m < std::numeric_limits<float>::infinity()) cells.see_over(cell, line_z_m);
    });
}

void VisibilityCleanup::find_gone(int block, std::int64_t time_ns, ElevationCells& cells) {
    const ElevationLayers& layers = cells.layers();
    const float* height_m = layers.height_m.data();
    const std::int64_t* agreed_ns = layers.seen_ns.data();
    RowBlocks(geometry_).for_each_cell(block, [&](grid::Cell at, std::size_t cell) {
        if (std::isnan(height_m[cell]) || agreed_ns[cell] == time_ns) return;
        // A line of sight that ended in this cell below the remembered height has passed the
        // surface as well.
        const float line_z_m = lines_.lowest_over(at);
        const float seen_z_m = ends_.z_m(cell);
        const float lowest_m = seen_z_m < line_z_m ? seen_z_m : line_z_m;
        if (!cells.is_above(cell, lowest_m)) return;
        // A surface that stands on the ground blocks all lines below its height; an overhanging
        // surface blocks only lines that meet it. A surface with a single observation may be a
        // wrong match, so the check treats it like a surface that stands.
        const bool stands =
            cells.bottom_m(cell) - lowest_m <= hangs_m_ || layers.count.data()[cell] == 1;
        if (!stands && !passed_through(at, height_m[cell])) return;
        if (cells.see_through(cell) && !stands_beside(at, time_ns, layers)) of_cell_[cell] = 1.0F;
    });
}

bool VisibilityCleanup::passed_through(grid::Cell cell, float z_m) const {
    return ends_.passed_through(cell, z_m - margin_m_, z_m + margin_m_);
}

bool VisibilityCleanup::stands_beside(grid::Cell cell,
                                      std::int64_t time_ns,
                                      const ElevationLayers& layers) const {
    // A frame often misses cells on an edge or cells that it observes edge-on, but not their
    // neighbours on the same object.
    const std::int64_t since_ns = time_ns - ns_from_seconds(config_.neighbour_s);
    const float height_m = layers.height_m.row(cell.iy)[cell.ix];
    const int last_iy = std::min(cell.iy + kBeside, geometry_.ny - 1);
    const int last_ix = std::min(cell.ix + kBeside, geometry_.nx - 1);
    for (int iy = std::max(cell.iy - kBeside, 0); iy <= last_iy; ++iy) {
        const float* other_m = layers.height_m.row(iy);
        const std::int64_t* agreed_ns = layers.seen_ns.row(iy);
        for (int ix = std::max(cell.ix - kBeside, 0); ix <= last_ix; ++ix) {
            if (agreed_ns[ix] >= since_ns && std::abs(other_m[ix] - height_m) < margin_m_) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace surefoot::elevation
