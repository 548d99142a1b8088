// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/settle.hpp"

#include <algorithm>
#include <vector>

#include "surefoot/stereo/match_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

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

/// With which disparity the right pixel of each left one was claimed.
void look_up(const Winners& winners, int v, const Claims& claims, std::uint8_t* claimed) {
    const std::uint8_t* const d = winners.disparity.row(v);
    for (int u = 0; u < winners.cost.width(); ++u) {
        claimed[u] = u < d[u]
                         ? std::uint8_t{0}
                         : static_cast<std::uint8_t>(claims[static_cast<std::size_t>(u - d[u])]);
    }
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
        std::vector<std::uint8_t> claimed(static_cast<std::size_t>(width));
        for (int v = first; v < last; ++v) {
            claim(winners, v, claims);
            look_up(winners, v, claims, claimed.data());
            rows::settle({winners.disparity.row(v),
                          winners.cost.row(v),
                          winners.cost_below.row(v),
                          winners.cost_above.row(v),
                          winners.second_cost.row(v),
                          claimed.data(),
                          width,
                          config.uniqueness_percent,
                          config.left_right_px,
                          disparity_px.row(v)});
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
