// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/match_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"
#include "surefoot/stereo/row_runs.hpp"

namespace surefoot::stereo {
namespace {

static_assert(kFarthest_px == rows::kFarthest_px);
constexpr float kSteepestGround = 0.4F;
constexpr int kBlockColumns = 256;

float right_pixel(int u, float disparity_px) noexcept {
    return std::floor(static_cast<float>(u) - disparity_px + 0.5F);
}

void drop_hidden_in_row(float* d, int width, float tolerance_px, std::vector<float>& claim) {
    claim.assign(static_cast<std::size_t>(width), 0.0F);
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        const float x = right_pixel(u, d[u]);
        if (!(x >= 0.0F && x < static_cast<float>(width))) {
            d[u] = kNanF;
            continue;
        }
        float& nearest = claim[static_cast<std::size_t>(x)];  // in range: as checked above
        nearest = std::max(nearest, d[u]);
    }
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        // in range: the loop above has set all others to NaN
        if (claim[static_cast<std::size_t>(right_pixel(u, d[u]))] > d[u] + tolerance_px)
            d[u] = kNanF;
    }
}

/// Marks jumps across holes, where no neighbour exists for comparison.
void mark_across_holes(const float* d,
                       const RowRuns& runs,
                       rows::JumpRule rule,
                       std::uint8_t* mark) {
    int before = -1;  // the last pixel of the previous run
    runs.for_each([&](int first, int last) {
        const float limit = rule.step_px + rule.slope * static_cast<float>(first - before);
        if (before >= 0 && std::abs(d[first] - d[before]) > limit) mark[before] = mark[first] = 255;
        before = last;
    });
}

}  // namespace

void drop_hidden(Executor& executor, double tolerance_px, Image<float>& disparity_px) {
    for_row_blocks(executor, disparity_px.height(), [&](int first, int last) {
        std::vector<float> claim;
        for (int v = first; v < last; ++v) {
            drop_hidden_in_row(
                disparity_px.row(v), disparity_px.width(), static_cast<float>(tolerance_px), claim);
        }
    });
}

void mark_jumps(Executor& executor,
                const Image<float>& disparity_px,
                double jump_px,
                Image<std::uint8_t>& jumps) {
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    jumps.resize(width, height);
    const rows::JumpRule rule{static_cast<float>(jump_px), kSteepestGround};
    constexpr int kRamp_px = rows::kRampHalf_px;
    for_row_blocks(executor, height, [&](int first, int last) {
        RowRuns runs;
        for (int v = first; v < last; ++v) {
            rows::mark_along(disparity_px.row(v), width, rule, jumps.row(v));
            runs.find(disparity_px.row(v), width, std::numeric_limits<float>::infinity());
            mark_across_holes(disparity_px.row(v), runs, rule, jumps.row(v));
            if (v < kRamp_px || v >= height - kRamp_px) continue;
            rows::mark_ramps(disparity_px.row(v - kRamp_px),
                             disparity_px.row(v + kRamp_px),
                             width,
                             rule,
                             jumps.row(v));
        }
    });
    if (height == 0) return;
    const int blocks = (width + kBlockColumns - 1) / kBlockColumns;
    executor.parallel_for(blocks, [&](int block) {
        const int u = block * kBlockColumns;
        const int count = std::min(kBlockColumns, width - u);
        float last_px[kBlockColumns];
        float rows_since[kBlockColumns] = {};
        std::copy_n(disparity_px.row(0) + u, count, last_px);
        for (int v = 1; v < height; ++v) {
            rows::mark_down(
                disparity_px.row(v) + u, count, rule, last_px, rows_since, jumps.row(v) + u, width);
        }
    });
}

void distance_to_marks(Executor& executor,
                       const Image<std::uint8_t>& marks,
                       Image<std::uint8_t>& distance_px) {
    const int width = marks.width();
    const int height = marks.height();
    distance_px.resize(width, height);
    // Spreads along each row first, then from row to row, straight or diagonally. These paths are
    // enough: if a path is longer along the row than down the column, its extra part can lie on the
    // row of the mark.
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<std::uint8_t> scratch(
            2 * static_cast<std::size_t>(width + 2 * rows::kSpreadMargin));
        for (int v = first; v < last; ++v)
            rows::spread_along(marks.row(v), width, scratch.data(), distance_px.row(v));
    });
    for (int v = 1; v < height; ++v)
        rows::spread_across(distance_px.row(v - 1), width, distance_px.row(v));
    for (int v = height - 2; v >= 0; --v)
        rows::spread_across(distance_px.row(v + 1), width, distance_px.row(v));
}

void smallest_nearby(Executor& executor,
                     const Image<float>& disparity_px,
                     Image<float>& smallest_px) {
    constexpr int kReach = rows::kNearby_px;
    constexpr int kLines = 2 * kReach + 1;
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    smallest_px.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        const auto columns = static_cast<std::size_t>(width);
        std::vector<float> scratch(columns + 2 * kReach);
        std::vector<float> ring(kLines * columns);  // row v is in line v % kLines
        const auto line = [&](int v) {
            return ring.data() + static_cast<std::size_t>((v + kLines) % kLines) * columns;
        };
        const auto take_row = [&](int v) {
            rows::smallest_along(
                disparity_px.row(std::clamp(v, 0, height - 1)), width, scratch.data(), line(v));
        };
        for (int v = first - kReach; v < first + kReach; ++v) take_row(v);
        for (int v = first; v < last; ++v) {
            take_row(v + kReach);
            const float* lines[kLines];
            for (int k = 0; k < kLines; ++k) lines[k] = line(v + k - kReach);
            rows::smallest_across(lines, width, smallest_px.row(v));
        }
    });
}

void count_unknown(Executor& executor,
                   const Image<float>& disparity_px,
                   int radius_px,
                   UnknownCounts& counts) {
    SUREFOOT_ASSERT(radius_px >= 0 && radius_px <= kMaxCountRadius_px);
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    counts.pixels.resize(width, height);
    counts.radius_px = radius_px;
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<std::uint8_t> padded(static_cast<std::size_t>(width + 2 * radius_px), 0);
        std::uint8_t* const columns = padded.data() + radius_px;
        const auto add_row = [&](int v, std::int8_t sign) {
            if (v < 0 || v >= height) return;
            rows::count_unknown(disparity_px.row(v), width, sign, columns);
        };
        for (int v = first - radius_px; v < first + radius_px; ++v) add_row(v, 1);
        for (int v = first; v < last; ++v) {
            add_row(v + radius_px, 1);
            rows::sum_windows(columns, width, radius_px, counts.pixels.row(v));
            add_row(v - radius_px, -1);
        }
    });
}

}  // namespace surefoot::stereo
