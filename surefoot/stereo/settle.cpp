// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/settle.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <vector>

#include "surefoot/stereo/refine_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kNoCost = 255;

/// What the left pixels of a row say about one pixel of the right row: cost * 256 + disparity of
/// the cheapest.
using Claims = std::vector<std::uint16_t>;
constexpr std::uint16_t kNoClaim = 0xffff;

void claim(const Winners& winners, int v, Claims& claims) {
    claims.assign(static_cast<std::size_t>(winners.cost.width()), kNoClaim);
    const std::uint8_t* const d = winners.disparity.row(v);
    const std::uint8_t* const cost = winners.cost.row(v);
    for (int u = 0; u < winners.cost.width(); ++u) {
        if (u < d[u]) continue;
        const auto offer = static_cast<std::uint16_t>(256 * cost[u] + d[u]);
        std::uint16_t& best = claims[static_cast<std::size_t>(u - d[u])];
        best = std::min(best, offer);
    }
}

/// Vertex of the parabola through the costs at -1, 0 and 1; 0 beside the ends of the range.
float vertex(int below, int here, int above) {
    const int curvature = below + above - 2 * here;
    if (below == kNoCost || above == kNoCost || curvature <= 0) return 0.0F;
    return static_cast<float>(below - above) / static_cast<float>(2 * curvature);
}

}  // namespace

void settle(const SettleConfig& config,
            const Winners& winners,
            Executor& executor,
            Image<float>& disparity_px) {
    const int width = winners.cost.width();
    const int height = winners.cost.height();
    disparity_px.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        Claims claims;
        for (int v = first; v < last; ++v) {
            claim(winners, v, claims);
            for (int u = 0; u < width; ++u) {
                const int d = winners.disparity.row(v)[u];
                const int cost = winners.cost.row(v)[u];
                float& out = disparity_px.row(v)[u];
                out = kNan;
                if (d == 0 || d > u) continue;
                const int second = winners.second_cost.row(v)[u];
                if (second * (100 - config.uniqueness_percent) < 100 * cost) continue;
                const int claimed = claims[static_cast<std::size_t>(u - d)] % 256;
                if (std::abs(claimed - d) > config.left_right_px) continue;
                out = static_cast<float>(d) +
                      vertex(winners.cost_below.row(v)[u], cost, winners.cost_above.row(v)[u]);
            }
        }
    });
}

void median_filter(const Image<float>& in, Executor& executor, Image<float>& out) {
    const int height = in.height();
    out.resize(in.width(), height);
    for_row_blocks(executor, height, [&](int first, int last) {
        for (int v = first; v < last; ++v) {
            const float* const lines[3] = {
                in.row(std::max(v - 1, 0)), in.row(v), in.row(std::min(v + 1, height - 1))};
            rows::median(lines, in.width(), out.row(v));
        }
    });
}

}  // namespace surefoot::stereo
