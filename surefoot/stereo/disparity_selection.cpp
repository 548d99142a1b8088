// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/disparity_selection.hpp"

#include <algorithm>
#include <vector>

#include "surefoot/stereo/match_rows.hpp"
#include "surefoot/stereo/row_blocks.hpp"

namespace surefoot::stereo {
namespace {

/// The claims of a row's left pixels on the pixels of the right row.
class Claims {
  public:
    explicit Claims(int width)
        : width_(static_cast<std::size_t>(width)),
          place_(width_),
          offer_(width_),
          best_(kOutside + width_) {}

    /// Finds for each left pixel the disparity of the cheapest claim on its right pixel.
    void look_up(const std::uint8_t* disparity, const std::uint8_t* cost, std::uint8_t* claimed) {
        rows::claim(disparity, cost, static_cast<int>(width_), place_.data(), offer_.data());
        std::fill(best_.begin(), best_.end(), kNoClaim);
        // Local copies, because the compiler must assume that the stores below change the members.
        const std::int32_t* const place = place_.data();
        const std::uint16_t* const offer = offer_.data();
        std::uint16_t* const best = best_.data() + kOutside;
        const std::size_t width = width_;
        const auto claim = [=](std::size_t u) {
            const std::uint16_t before = best[place[u]];
            best[place[u]] = before < offer[u] ? before : offer[u];
        };
        // Neighbouring pixels claim the same right pixels and would wait for each other. So the
        // loop processes one pixel of each half of the row together.
        const std::size_t half = width / 2;
        for (std::size_t u = 0; u < half; ++u) {
            claim(u);
            claim(u + half);
        }
        for (std::size_t u = 2 * half; u < width; ++u) claim(u);
        for (std::size_t u = 0; u < width; ++u)
            claimed[u] = static_cast<std::uint8_t>(best[place[u]]);
    }

  private:
    static constexpr std::uint16_t kNoClaim = 0xffff;
    /// Number of columns left of the right row that disparities can reach. Their results are never
    /// used.
    static constexpr std::size_t kOutside = 256;
    std::size_t width_;
    std::vector<std::int32_t> place_;
    std::vector<std::uint16_t> offer_;
    std::vector<std::uint16_t> best_;  ///< the lower byte is the disparity
};

}  // namespace

void select_disparities(const SelectionConfig& config,
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
            claims.look_up(winners.disparity.row(v), winners.cost.row(v), claimed.data());
            rows::select({winners.disparity.row(v),
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

void median_of_row(const Image<float>& in, int v, std::vector<float>& scratch, float* out) {
    const float* const lines[3] = {
        in.row(std::max(v - 1, 0)), in.row(v), in.row(std::min(v + 1, in.height() - 1))};
    scratch.resize(3 * static_cast<std::size_t>(in.width() + 2));
    rows::median(lines, in.width(), scratch.data(), out);
}

}  // namespace surefoot::stereo
