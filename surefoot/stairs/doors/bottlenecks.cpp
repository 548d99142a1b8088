// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/doors/bottlenecks.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Limit of the height range within a block. Floor has a smaller range, noise included; a block
/// with a wall has a larger range.
constexpr float kLevel_m = 0.1F;
constexpr std::int16_t kNone = -1;

/// Updates the lowest height, the highest height and the number of known cells of each column.
void take_row(const float* z_m, std::size_t count, float* low_m, float* high_m, int* known) {
    for (std::size_t i = 0; i < count; ++i) {
        known[i] += z_m[i] == z_m[i] ? 1 : 0;
        low_m[i] = z_m[i] < low_m[i] ? z_m[i] : low_m[i];
        high_m[i] = z_m[i] > high_m[i] ? z_m[i] : high_m[i];
    }
}

}  // namespace

const std::vector<Bottleneck>& BottleneckFinder::find(const Terrain& terrain,
                                                      const BottleneckLimits& limits) {
    bottlenecks_.clear();
    const grid::GridGeometry& geometry = terrain.geometry;
    cells_ = std::max(1, grid::whole_cells(std::round(kBlock_m / geometry.resolution_m)));
    block_m_ = cells_ * geometry.resolution_m;
    range_ = grid::whole_cells(std::ceil(0.5 * limits.max_width_m / block_m_)) + 1;
    if (geometry.nx < cells_ || geometry.ny < cells_) return bottlenecks_;
    measure_blocks(terrain);
    spread_ground();
    mark_walls(limits.rise_m);
    find_walls_in_columns();
    for (int by = 0; by < wall_.height(); ++by) find_nearest_walls(by);
    mark_bottlenecks(limits);
    for (int by = 0; by < bottleneck_.height(); ++by)
        for (int bx = 0; bx < bottleneck_.width(); ++bx)
            if (bottleneck_.row(by)[bx] != 0) collect({bx, by}, geometry, limits);
    std::sort(
        bottlenecks_.begin(), bottlenecks_.end(), [&](const Bottleneck& a, const Bottleneck& b) {
            return (a.middle_m - terrain.stance_m).squaredNorm() <
                   (b.middle_m - terrain.stance_m).squaredNorm();
        });
    return bottlenecks_;
}

/// Computes the blocks. An incomplete block at the far sides is left out.
void BottleneckFinder::measure_blocks(const Terrain& terrain) {
    const int nx = terrain.geometry.nx / cells_;
    const int ny = terrain.geometry.ny / cells_;
    reach_ = std::max(1, grid::whole_cells(std::round(kReach_m / block_m_)));
    low_m_.resize(nx + 2 * reach_, ny + 2 * reach_);
    low_m_.fill(kInfinity);
    high_m_.resize(nx, ny);
    high_m_.fill(-kInfinity);
    const auto cells = static_cast<std::size_t>(nx * cells_);
    for (int by = 0; by < ny; ++by) {
        float* low_m = low_m_.row(by + reach_) + reach_;
        float* high_m = high_m_.row(by);
        column_low_m_.assign(cells, kInfinity);
        column_high_m_.assign(cells, -kInfinity);
        column_known_.assign(cells, 0);
        for (int dy = 0; dy < cells_; ++dy) {
            take_row(terrain.height_m.row(by * cells_ + dy),
                     cells,
                     column_low_m_.data(),
                     column_high_m_.data(),
                     column_known_.data());
        }
        for (int bx = 0; bx < nx; ++bx) {
            int known = 0;
            float low = kInfinity;
            for (int ix = bx * cells_; ix < (bx + 1) * cells_; ++ix) {
                const auto i = static_cast<std::size_t>(ix);
                known += column_known_[i];
                low = std::min(low, column_low_m_[i]);
                high_m[bx] = std::max(high_m[bx], column_high_m_[i]);
            }
            const bool level = 2 * known >= cells_ * cells_ && high_m[bx] - low <= kLevel_m;
            if (level) low_m[bx] = low;
        }
    }
}

/// Finds the lowest level block within kReach_m on every side. Method: running minimum by doubling,
/// first along the rows, then along the columns.
void BottleneckFinder::spread_ground() {
    const int width = low_m_.width();
    const int height = low_m_.height();
    const int length = 2 * reach_ + 1;
    const auto lower = [](float* low_m, const float* other_m, int count) {
        for (int i = 0; i < count; ++i) low_m[i] = other_m[i] < low_m[i] ? other_m[i] : low_m[i];
    };
    for (int run = 1; run < length; run = std::min(2 * run, length)) {
        const int apart = std::min(run, length - run);
        for (int y = 0; y < height; ++y) lower(low_m_.row(y), low_m_.row(y) + apart, width - apart);
    }
    for (int run = 1; run < length; run = std::min(2 * run, length)) {
        const int apart = std::min(run, length - run);
        for (int y = 0; y + apart < height; ++y) lower(low_m_.row(y), low_m_.row(y + apart), width);
    }
}

/// Marks a high block as a wall if at least two of its eight neighbours are high too, because wrong
/// matches are isolated.
void BottleneckFinder::mark_walls(double rise_m) {
    const int nx = high_m_.width();
    const int ny = high_m_.height();
    wall_.resize(nx, ny);
    wall_.fill(0);
    bottleneck_.resize(nx, ny);
    const auto rise = static_cast<float>(rise_m);
    for (int by = 0; by < ny; ++by) {
        // The image `low_m_` has a margin of `reach_` blocks, so a window begins at the index of
        // its block.
        const float* ground_m = low_m_.row(by);
        for (int bx = 0; bx < nx; ++bx)
            bottleneck_.row(by)[bx] = high_m_.row(by)[bx] >= ground_m[bx] + rise ? 1 : 0;
    }
    for (int by = 1; by < ny - 1; ++by) {
        for (int bx = 1; bx < nx - 1; ++bx) {
            if (bottleneck_.row(by)[bx] == 0) continue;
            int beside = -1;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) beside += bottleneck_.row(by + dy)[bx + dx];
            wall_.row(by)[bx] = beside >= 2 ? 1 : 0;
        }
    }
}

void BottleneckFinder::find_walls_in_columns() {
    const int nx = wall_.width();
    const int ny = wall_.height();
    wall_by_.resize(nx, ny);
    wall_bx_.resize(nx, ny);
    for (int by = 0; by < ny; ++by) {
        for (int bx = 0; bx < nx; ++bx) {
            const std::int16_t above = by > 0 ? wall_by_.row(by - 1)[bx] : kNone;
            wall_by_.row(by)[bx] = wall_.row(by)[bx] != 0 ? static_cast<std::int16_t>(by) : above;
        }
    }
    for (int by = ny - 2; by >= 0; --by) {
        for (int bx = 0; bx < nx; ++bx) {
            const std::int16_t after = wall_by_.row(by + 1)[bx];
            std::int16_t& nearest = wall_by_.row(by)[bx];
            if (after > by && (nearest < 0 || after - by < by - nearest)) nearest = after;
        }
    }
}

/// Finds the column of the nearest wall for each block of a row. Method: lower envelope of the
/// parabolas (bx - column)^2 + (rows to the column's wall)^2. Walls beyond the reach of any
/// bottleneck are left out.
void BottleneckFinder::find_nearest_walls(int by) {
    const int nx = wall_.width();
    const std::int16_t* wall_by = wall_by_.row(by);
    const auto height = [&](int bx) {
        const double rows = wall_by[bx] - by;
        return rows * rows;
    };
    envelope_.clear();
    for (int bx = 0; bx < nx; ++bx) {
        if (wall_by[bx] < 0 || std::abs(wall_by[bx] - by) > range_) continue;
        double from = -std::numeric_limits<double>::infinity();
        while (!envelope_.empty()) {
            const auto& last = envelope_.back();
            from = (height(bx) - height(last.bx) + bx * bx - last.bx * last.bx) /
                   (2.0 * (bx - last.bx));
            if (from > last.from) break;
            envelope_.pop_back();
            from = -std::numeric_limits<double>::infinity();
        }
        envelope_.push_back({bx, from});
    }
    std::int16_t* out = wall_bx_.row(by);
    if (envelope_.empty()) {
        std::fill_n(out, nx, kNone);
        return;
    }
    std::size_t k = 0;
    for (int bx = 0; bx < nx; ++bx) {
        while (k + 1 < envelope_.size() && envelope_[k + 1].from <= bx) ++k;
        out[bx] = static_cast<std::int16_t>(envelope_[k].bx);
    }
}

Vector2i BottleneckFinder::to_wall(int bx, int by) const {
    const int column = wall_bx_.row(by)[bx];
    return {column - bx, wall_by_.row(by)[column] - by};
}

bool BottleneckFinder::in_bottleneck(int bx, int by, const BottleneckLimits& limits) const {
    if (wall_bx_.row(by)[bx] < 0 || wall_.row(by)[bx] != 0 || high_m_.row(by)[bx] == -kInfinity)
        return false;
    const Vector2i near = to_wall(bx, by);
    if (near.squaredNorm() > range_ * range_) return false;
    // The width is uncertain by two blocks: a block with any part of a wall counts as wall, and the
    // middle may lie between two blocks.
    const double width = 2.0 * near.cast<double>().norm();
    if ((width + 2.0) * block_m_ < limits.min_width_m ||
        (width - 2.0) * block_m_ > limits.max_width_m)
        return false;
    const Vector2i opposite = Vector2i(bx, by) - near;
    if (!bottleneck_.contains(opposite.x(), opposite.y()) ||
        wall_bx_.row(opposite.y())[opposite.x()] < 0)
        return false;
    // The opposite wall must be at most two blocks away from the opposite point.
    return to_wall(opposite.x(), opposite.y()).squaredNorm() <= 4;
}

void BottleneckFinder::mark_bottlenecks(const BottleneckLimits& limits) {
    for (int by = 0; by < bottleneck_.height(); ++by)
        for (int bx = 0; bx < bottleneck_.width(); ++bx)
            bottleneck_.row(by)[bx] = in_bottleneck(bx, by, limits) ? 1 : 0;
}

void BottleneckFinder::collect(grid::Cell first,
                               const grid::GridGeometry& geometry,
                               const BottleneckLimits& limits) {
    constexpr int kGap = 2;  // blocks
    members_.clear();
    members_.push_back(first);
    bottleneck_.row(first.iy)[first.ix] = 0;
    Vector2d middle = Vector2d::Zero();
    Vector2d across = Vector2d::Zero();
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const grid::Cell cell = members_[i];
        const Vector2d way = to_wall(cell.ix, cell.iy).cast<double>();
        across += across.dot(way) < 0.0 ? -way : way;
        middle += Vector2d(cell.ix + 0.5, cell.iy + 0.5);
        for (int by = std::max(0, cell.iy - kGap);
             by <= std::min(bottleneck_.height() - 1, cell.iy + kGap);
             ++by) {
            for (int bx = std::max(0, cell.ix - kGap);
                 bx <= std::min(bottleneck_.width() - 1, cell.ix + kGap);
                 ++bx) {
                if (bottleneck_.row(by)[bx] == 0) continue;
                bottleneck_.row(by)[bx] = 0;
                members_.push_back({bx, by});
            }
        }
    }
    const auto count = static_cast<double>(members_.size());
    Bottleneck bottleneck;
    bottleneck.width_m = 2.0 * across.norm() / count * block_m_;
    bottleneck.across = across.normalized();
    bottleneck.middle_m = geometry.origin_m + middle / count * block_m_;
    const Vector2d along(-bottleneck.across.y(), bottleneck.across.x());
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const grid::Cell cell : members_) {
        const double at = along.dot(Vector2d(cell.ix, cell.iy)) * block_m_;
        least = std::min(least, at);
        most = std::max(most, at);
    }
    if (most - least + block_m_ <= limits.max_depth_m) bottlenecks_.push_back(bottleneck);
}

}  // namespace surefoot::stairs
