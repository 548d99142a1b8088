// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_bounds.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns the largest k with 2^k <= cells.
int level_of(int cells) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(cells))) - 1;
}

/// Calls f(row) for every row; each block of rows is one work item.
template <typename F>
void for_row_blocks(Executor& executor, int rows, int block_rows, const F& f) {
    const int blocks = (rows + block_rows - 1) / block_rows;
    struct Job {
        const F& f;
        int rows;
        int block_rows;
    } job{f, rows, block_rows};
    // The closure holds one reference only, so std::function allocates no memory.
    executor.parallel_for(blocks, [&job](int block) {
        const int first = block * job.block_rows;
        for (int iy = first; iy < std::min(first + job.block_rows, job.rows); ++iy) job.f(iy);
    });
}

}  // namespace

int HeightBounds::reach(const Input& input, int ix, int iy) {
    const double drift_m = static_cast<double>(input.horizontal_drift_m.row(iy)[ix]);
    const int most = std::max(input.height_m.width, input.height_m.height);
    const double cells = std::ceil(input.sigmas * drift_m / input.resolution_m);
    return cells < most ? std::max(0, static_cast<int>(cells)) : most;  // NaN: the whole map
}

int HeightBounds::longest_reach(const Input& input) const {
    int longest = 0;
    for (int iy = 0; iy < input.height_m.height; ++iy) {
        for (int ix = 0; ix < input.height_m.width; ++ix) {
            if (!std::isnan(input.height_m.row(iy)[ix])) {
                longest = std::max(longest, reach(input, ix, iy));
            }
        }
    }
    return longest;
}

void HeightBounds::compute(const Input& input,
                           Executor& executor,
                           grid::Layer& lower_m,
                           grid::Layer& upper_m) {
    const int nx = input.height_m.width;
    const int ny = input.height_m.height;
    lower_m.resize(nx, ny);
    upper_m.resize(nx, ny);
    if (input.height_m.empty()) return;
    const int widest = std::min({2 * longest_reach(input) + 1, nx, ny});
    build(input, level_of(widest) + 1, executor);
    for_row_blocks(
        executor, ny, kBlockRows, [&](int iy) { answer_row(input, iy, lower_m, upper_m); });
}

void HeightBounds::build(const Input& input, int levels, Executor& executor) {
    const int nx = input.height_m.width;
    const int ny = input.height_m.height;
    if (levels_.size() < static_cast<std::size_t>(levels)) {
        levels_.resize(static_cast<std::size_t>(levels));
    }
    const auto sigmas = static_cast<float>(input.sigmas);
    for (int level = 0; level < levels; ++level) {
        Level& table = levels_[static_cast<std::size_t>(level)];
        table.lowest_m.resize(nx, ny);
        table.highest_m.resize(nx, ny);
        for_row_blocks(executor, ny, kBlockRows, [&](int iy) {
            if (level > 0) {
                build_row(level, iy);
                return;
            }
            const float* height_m = input.height_m.row(iy);
            const float* var_m2 = input.height_var_m2.row(iy);
            float* lowest_m = table.lowest_m.row(iy);
            float* highest_m = table.highest_m.row(iy);
            for (int ix = 0; ix < nx; ++ix) {
                const bool known = !std::isnan(height_m[ix]);
                const float spread_m = sigmas * std::sqrt(var_m2[ix]);
                lowest_m[ix] = known ? height_m[ix] - spread_m : kInfinity;
                highest_m[ix] = known ? height_m[ix] + spread_m : -kInfinity;
            }
        });
    }
}

void HeightBounds::build_row(int level, int iy) {
    const Level& smaller = levels_[static_cast<std::size_t>(level) - 1];
    Level& table = levels_[static_cast<std::size_t>(level)];
    const int nx = table.lowest_m.width();
    const int half = 1 << (level - 1);
    const int other_iy = std::min(iy + half, table.lowest_m.height() - 1);
    const auto combine = [&](const grid::Layer& from, grid::Layer& to, const auto& better) {
        const float* a = from.row(iy);
        const float* b = from.row(other_iy);
        float* out = to.row(iy);
        const int whole = std::max(0, nx - half);
        for (int ix = 0; ix < whole; ++ix) {
            out[ix] = better(better(a[ix], a[ix + half]), better(b[ix], b[ix + half]));
        }
        for (int ix = whole; ix < nx; ++ix) out[ix] = better(a[ix], b[ix]);
    };
    combine(smaller.lowest_m, table.lowest_m, [](float p, float q) { return p < q ? p : q; });
    combine(smaller.highest_m, table.highest_m, [](float p, float q) { return p > q ? p : q; });
}

void HeightBounds::answer_row(const Input& input,
                              int iy,
                              grid::Layer& lower_m,
                              grid::Layer& upper_m) const {
    const int nx = input.height_m.width;
    const int ny = input.height_m.height;
    for (int ix = 0; ix < nx; ++ix) {
        float lowest_m = kNanF;
        float highest_m = kNanF;
        if (!std::isnan(input.height_m.row(iy)[ix])) {
            const int cells = reach(input, ix, iy);
            const int x0 = std::max(ix - cells, 0);
            const int x1 = std::min(ix + cells, nx - 1);
            const int y0 = std::max(iy - cells, 0);
            const int y1 = std::min(iy + cells, ny - 1);
            const int level = level_of(std::min(x1 - x0, y1 - y0) + 1);
            const Level& table = levels_[static_cast<std::size_t>(level)];
            const int side = 1 << level;
            lowest_m = kInfinity;
            highest_m = -kInfinity;
            // Two by two overlapping blocks cover the square. Only a square that the border cuts
            // needs more blocks.
            for (int y = y0;; y = std::min(y + side, y1 - side + 1)) {
                for (int x = x0;; x = std::min(x + side, x1 - side + 1)) {
                    lowest_m = std::min(lowest_m, table.lowest_m.row(y)[x]);
                    highest_m = std::max(highest_m, table.highest_m.row(y)[x]);
                    if (x + side > x1) break;
                }
                if (y + side > y1) break;
            }
        }
        lower_m.row(iy)[ix] = lowest_m;
        upper_m.row(iy)[ix] = highest_m;
    }
}

}  // namespace surefoot::elevation
