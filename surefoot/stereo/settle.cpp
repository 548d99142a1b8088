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
class Claims {
  public:
    explicit Claims(int width) : claims_(static_cast<std::size_t>(width + kOutside)) {}

    void take(const std::uint8_t* disparity, const std::uint8_t* cost, int width) {
        std::fill(claims_.begin(), claims_.end(), kNoClaim);
        std::uint16_t* const claims = claims_.data() + kOutside;
        for (int u = 0; u < width; ++u) {
            const auto offer = static_cast<std::uint16_t>(256 * cost[u] + disparity[u]);
            std::uint16_t& best = claims[u - disparity[u]];
            best = std::min(best, offer);
        }
    }
    /// With which disparity the right pixel of each left one was claimed.
    void look_up(const std::uint8_t* disparity, int width, std::uint8_t* claimed) const {
        const std::uint16_t* const claims = claims_.data() + kOutside;
        for (int u = 0; u < width; ++u)
            claimed[u] = static_cast<std::uint8_t>(claims[u - disparity[u]]);
    }

  private:
    static constexpr std::uint16_t kNoClaim = 0xffff;
    /// Left of the right row lie as many pixels as disparities reach: their claims do no harm.
    static constexpr int kOutside = 256;
    std::vector<std::uint16_t> claims_;
};

}  // namespace

void settle(const SettleConfig& config,
            const Winners& winners,
            Executor& executor,
            Image<float>& disparity_px) {
    const int width = winners.cost.width();
    const int height = winners.cost.height();
    disparity_px.resize(width, height);
    for_row_blocks(executor, height, [&](int first, int last) {
        Claims claims(width);
        std::vector<std::uint8_t> claimed(static_cast<std::size_t>(width));
        for (int v = first; v < last; ++v) {
            claims.take(winners.disparity.row(v), winners.cost.row(v), width);
            claims.look_up(winners.disparity.row(v), width, claimed.data());
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
        std::vector<float> scratch(3 * static_cast<std::size_t>(in.width() + 2));
        for (int v = first; v < last; ++v) {
            const float* const lines[3] = {
                in.row(std::max(v - 1, 0)), in.row(v), in.row(std::min(v + 1, height - 1))};
            rows::median(lines, in.width(), scratch.data(), out.row(v));
        }
    });
}

}  // namespace surefoot::stereo
