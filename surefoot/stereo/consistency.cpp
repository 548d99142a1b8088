// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/match_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
static_assert(kFarthest_px == 15, "steps of 1, 2, 4 and 8 reach that far");
constexpr float kSteepestGround = 0.4F;
constexpr int kBlockColumns = 256;

int right_pixel(int u, float disparity_px) noexcept {
    return static_cast<int>(std::floor(static_cast<float>(u) - disparity_px + 0.5F));
}

void drop_hidden_in_row(float* d, int width, float tolerance_px, std::vector<float>& claim) {
    claim.assign(static_cast<std::size_t>(width), 0.0F);
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        const int x = right_pixel(u, d[u]);
        if (x < 0 || x >= width) {
            d[u] = kNan;
            continue;
        }
        float& nearest = claim[static_cast<std::size_t>(x)];
        nearest = std::max(nearest, d[u]);
    }
    for (int u = 0; u < width; ++u) {
        if (std::isnan(d[u])) continue;
        if (claim[static_cast<std::size_t>(right_pixel(u, d[u]))] > d[u] + tolerance_px)
            d[u] = kNan;
    }
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
        for (int v = first; v < last; ++v) {
            rows::mark_along(disparity_px.row(v), width, rule, jumps.row(v));
            if (v < kRamp_px || v >= height - kRamp_px) continue;
            rows::mark_ramps(disparity_px.row(v - kRamp_px),
                             disparity_px.row(v + kRamp_px),
                             width,
                             rule,
                             jumps.row(v));
        }
    });
    // Both sides of a jump along a column: what differs from the last known pixel on the way down,
    // and on the way up.
    const int blocks = (width + kBlockColumns - 1) / kBlockColumns;
    executor.parallel_for(blocks, [&](int block) {
        const int u = block * kBlockColumns;
        const int count = std::min(kBlockColumns, width - u);
        float last_px[kBlockColumns];
        float rows_since[kBlockColumns];
        for (const bool down : {true, false}) {
            std::fill_n(last_px, kBlockColumns, kNan);
            std::fill_n(rows_since, kBlockColumns, 0.0F);
            for (int k = 0; k < height; ++k) {
                const int v = down ? k : height - 1 - k;
                rows::mark_from_last(
                    disparity_px.row(v) + u, count, rule, last_px, rows_since, jumps.row(v) + u);
            }
        }
    });
}

void distance_to_marks(Executor& executor,
                       const Image<std::uint8_t>& marks,
                       Image<std::uint8_t>& distance_px) {
    const int width = marks.width();
    const int height = marks.height();
    distance_px.resize(width, height);
    // Along each row, in steps of 1, 2, 4 and 8; then from row to row, straight or aslant. A longer
    // way along the row than down the column takes its first part along the row of the mark.
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<std::uint8_t> before(static_cast<std::size_t>(width));
        for (int v = first; v < last; ++v) {
            std::uint8_t* const d = distance_px.row(v);
            const std::uint8_t* const mark = marks.row(v);
            for (int u = 0; u < width; ++u) d[u] = mark[u] != 0 ? 0 : 255;
            for (int step = 1; step <= std::min(kFarthest_px, width - 1); step *= 2) {
                std::copy(d, d + width, before.begin());
                const std::uint8_t* const b = before.data();
                rows::nearer(b + step, step, kFarthest_px, width - step, d);
                rows::nearer(b, step, kFarthest_px, width - step, d + step);
            }
        }
    });
    const auto pass = [&](int v, int from) {
        std::uint8_t* const d = distance_px.row(v);
        const std::uint8_t* const b = distance_px.row(from);
        rows::nearer(b, 1, kFarthest_px, width, d);
        rows::nearer(b + 1, 1, kFarthest_px, width - 1, d);
        rows::nearer(b, 1, kFarthest_px, width - 1, d + 1);
    };
    for (int v = 1; v < height; ++v) pass(v, v - 1);
    for (int v = height - 2; v >= 0; --v) pass(v, v + 1);
}

void unknown_share(Executor& executor,
                   const Image<float>& disparity_px,
                   int radius_px,
                   Image<float>& share) {
    SUREFOOT_ASSERT(radius_px >= 0 && radius_px <= kMaxShareRadius_px);
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    share.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        std::vector<std::uint8_t> padded(static_cast<std::size_t>(width + 2 * radius_px), 0);
        std::uint8_t* const counts = padded.data() + radius_px;
        const auto add_row = [&](int v, std::int8_t sign) {
            if (v < 0 || v >= height) return;
            rows::count_unknown(disparity_px.row(v), width, sign, counts);
        };
        for (int v = first - radius_px; v < first + radius_px; ++v) add_row(v, 1);
        for (int v = first; v < last; ++v) {
            add_row(v + radius_px, 1);
            const int present =
                std::min(height - 1, v + radius_px) - std::max(0, v - radius_px) + 1;
            rows::unknown_share(counts, width, radius_px, present, share.row(v));
            add_row(v - radius_px, -1);
        }
    });
}

}  // namespace surefoot::stereo
