// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/stereo/census_window.hpp"
#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kNone = 255;      ///< path cost outside the range; sums within a range end here too
constexpr int kOutside = 1000;  ///< sum outside the range

std::uint32_t census_word(ImageView<const std::uint8_t> image, int u, int v) {
    const auto window = census_window();
    std::uint32_t word = 0;
    for (std::size_t bit = 0; bit < window.size(); ++bit) {
        const int nu = std::clamp(u + window[bit].du, 0, image.width - 1);
        const int nv = std::clamp(v + window[bit].dv, 0, image.height - 1);
        if (image.at(nu, nv) < image.at(u, v)) word |= std::uint32_t{1} << bit;
    }
    return word;
}

/// Disparities [begin, end) that a block searches.
struct Range {
    int begin = 0;
    int end = 0;
};

/// A cost for each pixel and disparity.
struct Volume {
    int width = 0;
    int height = 0;
    int disparities = 0;
    std::vector<std::vector<int>> costs;

    Volume(int columns, int rows, int count)
        : width(columns),
          height(rows),
          disparities(count),
          costs(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                std::vector<int>(static_cast<std::size_t>(count), 0)) {}
    [[nodiscard]] std::vector<int>& at(int u, int v) { return costs[index(u, v)]; }
    [[nodiscard]] const std::vector<int>& at(int u, int v) const { return costs[index(u, v)]; }
    [[nodiscard]] std::size_t index(int u, int v) const {
        return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(u);
    }
};

/// What a level takes from the level of half its size: sums of costs minus the least sum.
struct Coarse {
    Volume relative;

    [[nodiscard]] int prior(int u, int v, int d) const {
        const auto at = [&](int coarse) {
            const int cost = relative.at(u / 2, v / 2)[static_cast<std::size_t>(coarse)];
            return cost >> kPriorShift;
        };
        return (at(d / 2) + at(std::min(d / 2 + d % 2, relative.disparities - 1)) + 1) / 2;
    }
    [[nodiscard]] Range range(int block_x, int block_y, int disparities) const {
        constexpr int kHalf = kBlockSide_px / 2;
        int first = relative.disparities;
        int last = 0;
        for (int v = block_y * kHalf; v < std::min((block_y + 1) * kHalf, relative.height); ++v) {
            for (int u = block_x * kHalf; u < std::min((block_x + 1) * kHalf, relative.width);
                 ++u) {
                for (int d = 0; d < relative.disparities; ++d) {
                    if (relative.at(u, v)[static_cast<std::size_t>(d)] >= kHopeless) continue;
                    first = std::min(first, d);
                    last = std::max(last, d);
                }
            }
        }
        const auto steps_up = [](int d) { return (d + kRangeStep - 1) / kRangeStep * kRangeStep; };
        return {std::max(0, 2 * first - kRangeMargin) / kRangeStep * kRangeStep,
                std::min(disparities, steps_up(2 * (last + 1) + kRangeMargin))};
    }
};

/// Costs of all disparities of one pixel along one path.
using PathCosts = std::vector<int>;

int jump_penalty(const SemiGlobalConfig& config, int grey, int grey_before) {
    const int contrast = std::abs(grey - grey_before) >> config.contrast_shift;
    return std::max(config.min_jump_penalty, config.jump_penalty - contrast);
}

/// Computes L(p, d) = C(p, d) + min(L(p-r, d), L(p-r, d +- 1) + P1, min L(p-r) + P2) - min L(p-r)
/// for the disparities of the range.
PathCosts step(const PathCosts& before, const PathCosts& match, Range range, int slope, int jump) {
    const int least = *std::min_element(before.begin(), before.end());
    PathCosts costs(before.size(), kNone);
    const auto cost_before = [&](int d) {
        return d >= range.begin && d < range.end ? before[static_cast<std::size_t>(d)] : kNone;
    };
    for (int d = range.begin; d < range.end; ++d) {
        const int best = std::min(
            {cost_before(d), cost_before(d - 1) + slope, cost_before(d + 1) + slope, least + jump});
        const auto at = static_cast<std::size_t>(d);
        costs[at] = match[at] + best - least;
    }
    return costs;
}

/// Sums the costs of the four paths of one level.
class Level {
  public:
    Level(const SemiGlobalConfig& config,
          ImageView<const std::uint8_t> left,
          ImageView<const std::uint8_t> right,
          const Coarse* coarse)
        : config_(config),
          left_(left),
          match_(left.width, left.height, config.disparities),
          sums_(left.width, left.height, config.disparities) {
        for (int v = 0; v < left.height; ++v) {
            for (int u = 0; u < left.width; ++u) {
                const std::uint32_t word = census_word(left, u, v);
                for (int d = 0; d < config.disparities; ++d)
                    match_.at(u, v)[static_cast<std::size_t>(d)] =
                        std::popcount(word ^ census_word(right, std::max(u - d, 0), v)) +
                        (coarse != nullptr ? coarse->prior(u, v, d) : 0);
            }
        }
        for (int y = 0; y * kBlockSide_px < left.height; ++y)
            for (int x = 0; x * kBlockSide_px < left.width; ++x)
                ranges_.push_back(coarse != nullptr ? coarse->range(x, y, config.disparities)
                                                    : Range{0, config.disparities});
    }

    [[nodiscard]] const Volume& sum_paths() {
        for (int v = 0; v < left_.height; ++v) {
            follow(0, v, 1, 0);
            follow(left_.width - 1, v, -1, 0);
        }
        for (int u = 0; u < left_.width; ++u) {
            follow(u, 0, 0, 1);
            follow(u, left_.height - 1, 0, -1);
        }
        for (int v = 0; v < left_.height; ++v) {
            for (int u = 0; u < left_.width; ++u) {
                const Range range = range_at(u, v);
                std::vector<int>& sums = sums_.at(u, v);
                for (int d = 0; d < config_.disparities; ++d) {
                    int& sum = sums[static_cast<std::size_t>(d)];
                    sum = d >= range.begin && d < range.end ? std::min(sum, kNone) : kOutside;
                }
            }
        }
        return sums_;
    }

  private:
    [[nodiscard]] Range range_at(int u, int v) const {
        const int blocks = (left_.width + kBlockSide_px - 1) / kBlockSide_px;
        const int block = v / kBlockSide_px * blocks + u / kBlockSide_px;
        return ranges_[static_cast<std::size_t>(block)];
    }
    /// Follows one path from the pixel (u, v) at the image border to the other border.
    void follow(int u, int v, int du, int dv) {
        PathCosts before(static_cast<std::size_t>(config_.disparities), 0);
        int grey_before = left_.at(u, v);
        for (; u >= 0 && u < left_.width && v >= 0 && v < left_.height; u += du, v += dv) {
            const int jump = jump_penalty(config_, left_.at(u, v), grey_before);
            before = step(before, match_.at(u, v), range_at(u, v), config_.slope_penalty, jump);
            for (std::size_t d = 0; d < before.size(); ++d) sums_.at(u, v)[d] += before[d];
            grey_before = left_.at(u, v);
        }
    }

    const SemiGlobalConfig& config_;
    ImageView<const std::uint8_t> left_;
    Volume match_;
    Volume sums_;
    std::vector<Range> ranges_;
};

Volume sums_of(const SemiGlobalConfig& config,
               ImageView<const std::uint8_t> left,
               ImageView<const std::uint8_t> right) {
    if (left.width / 2 < kLeastLevelWidth_px)
        return Level(config, left, right, nullptr).sum_paths();
    SemiGlobalConfig half = config;
    half.disparities = (config.disparities + 1) / 2;
    GreyImage half_left, half_right;
    halve(left, half_left);
    halve(right, half_right);
    Coarse coarse{sums_of(half, half_left.view(), half_right.view())};
    for (int v = 0; v < half_left.height(); ++v) {
        for (int u = 0; u < half_left.width(); ++u) {
            std::vector<int>& sums = coarse.relative.at(u, v);
            const int least = *std::min_element(sums.begin(), sums.end());
            for (int& sum : sums) sum = sum == kOutside ? kNone : sum - least;
        }
    }
    return Level(config, left, right, &coarse).sum_paths();
}

void keep_winner(const std::vector<int>& sums, int u, int v, Winners& out) {
    const int count = static_cast<int>(sums.size());
    const int best = static_cast<int>(std::min_element(sums.begin(), sums.end()) - sums.begin());
    const auto cost_at = [&](int d) {
        return d >= 0 && d < count ? std::min(sums[static_cast<std::size_t>(d)], kNone) : kNone;
    };
    int second = kNone;
    for (int d = 0; d < count; ++d) {
        if (std::abs(d - best) >= 2) second = std::min(second, cost_at(d));
    }
    out.disparity.at(u, v) = static_cast<std::uint8_t>(best);
    out.cost.at(u, v) = static_cast<std::uint8_t>(cost_at(best));
    out.cost_below.at(u, v) = static_cast<std::uint8_t>(cost_at(best - 1));
    out.cost_above.at(u, v) = static_cast<std::uint8_t>(cost_at(best + 1));
    out.second_cost.at(u, v) = static_cast<std::uint8_t>(second);
}

}  // namespace

std::optional<std::string> SemiGlobalConfig::problem() const {
    if (disparities < 1 || disparities > 256)
        return fmt::format("semi-global search: {} disparities; the value must be from 1 to 256",
                           disparities);
    if (slope_penalty < 0 || slope_penalty > kNone || min_jump_penalty < 0 || contrast_shift < 0 ||
        contrast_shift > 8)
        return fmt::format(
            "semi-global search: slope penalty {}, least jump penalty {}, contrast shift {}; they "
            "must be from 0 to 255, at least 0, and from 0 to 8",
            slope_penalty,
            min_jump_penalty,
            contrast_shift);
    constexpr int kMaxJump = 100;  // two path costs of kCensusBits + kMaxPrior + P2 fit into a byte
    static_assert(2 * (kCensusBits + kMaxPrior + kMaxJump) < kNone);
    if (jump_penalty < min_jump_penalty || jump_penalty > kMaxJump) {
        return fmt::format("semi-global search: jump penalty {}; the value must be from {} to {}",
                           jump_penalty,
                           min_jump_penalty,
                           kMaxJump);
    }
    return std::nullopt;
}

void Winners::resize(int width, int height) {
    for (auto* image : {&disparity, &cost, &cost_below, &cost_above, &second_cost})
        image->resize(width, height);
}

void search_plainly(const SemiGlobalConfig& config,
                    ImageView<const std::uint8_t> left,
                    ImageView<const std::uint8_t> right,
                    Winners& out) {
    SUREFOOT_ASSERT(!config.problem() && left.width == right.width && left.height == right.height);
    const Volume sums = sums_of(config, left, right);
    out.resize(left.width, left.height);
    for (int v = 0; v < left.height; ++v)
        for (int u = 0; u < left.width; ++u) keep_winner(sums.at(u, v), u, v, out);
}

}  // namespace surefoot::stereo
