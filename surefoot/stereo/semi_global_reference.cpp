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

/// Costs of all disparities of one pixel along one path.
using PathCosts = std::vector<int>;

int jump_penalty(const SemiGlobalConfig& config, int grey, int grey_before) {
    const int contrast = std::abs(grey - grey_before) >> config.contrast_shift;
    return std::max(config.min_jump_penalty, config.jump_penalty - contrast);
}

/// Computes L(p, d) = C(p, d) + min(L(p-r, d), L(p-r, d +- 1) + P1, min L(p-r) + P2) - min L(p-r).
PathCosts step(const PathCosts& before, const PathCosts& match_costs, int slope, int jump) {
    const int least = *std::min_element(before.begin(), before.end());
    PathCosts costs(before.size());
    for (std::size_t d = 0; d < costs.size(); ++d) {
        int best = std::min(before[d], least + jump);
        if (d > 0) best = std::min(best, before[d - 1] + slope);
        if (d + 1 < costs.size()) best = std::min(best, before[d + 1] + slope);
        costs[d] = match_costs[d] + best - least;
    }
    return costs;
}

void keep_winner(const PathCosts& sums, int u, int v, Winners& out) {
    const int count = static_cast<int>(sums.size());
    const int best = static_cast<int>(std::min_element(sums.begin(), sums.end()) - sums.begin());
    const auto cost_at = [&](int d) {
        return d >= 0 && d < count ? sums[static_cast<std::size_t>(d)] : 255;
    };
    int second = 255;
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
    if (slope_penalty < 0 || min_jump_penalty < 0 || contrast_shift < 0 || contrast_shift > 8)
        return std::string(
            "semi-global search: the penalties must be at least 0, and the contrast shift must be "
            "from 0 to 8");
    if (jump_penalty < min_jump_penalty || 3 * (kCensusBits + jump_penalty) >= 255) {
        return fmt::format("semi-global search: jump penalty {}; the value must be from {} to {}",
                           jump_penalty,
                           min_jump_penalty,
                           254 / 3 - kCensusBits);
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
    const int width = left.width;
    const auto columns = static_cast<std::size_t>(width);
    const PathCosts start(static_cast<std::size_t>(config.disparities), 0);
    out.resize(width, left.height);
    std::vector<PathCosts> from_above(columns, start);
    std::vector<PathCosts> match_costs(columns, start);
    std::vector<PathCosts> sums(columns, start);
    for (int v = 0; v < left.height; ++v) {
        for (int u = 0; u < width; ++u) {
            const std::uint32_t word = census_word(left, u, v);
            for (int d = 0; d < config.disparities; ++d) {
                match_costs[static_cast<std::size_t>(u)][static_cast<std::size_t>(d)] =
                    std::popcount(word ^ census_word(right, std::max(u - d, 0), v));
            }
        }
        const auto follow = [&](int u, const PathCosts& before, int grey_before) {
            const auto column = static_cast<std::size_t>(u);
            const int jump = jump_penalty(config, left.at(u, v), grey_before);
            PathCosts costs = step(before, match_costs[column], config.slope_penalty, jump);
            for (std::size_t d = 0; d < costs.size(); ++d) sums[column][d] += costs[d];
            return costs;
        };
        sums.assign(columns, start);
        PathCosts along = start;
        for (int u = 0; u < width; ++u) along = follow(u, along, left.at(std::max(u - 1, 0), v));
        along = start;
        for (int u = width - 1; u >= 0; --u)
            along = follow(u, along, left.at(std::min(u + 1, width - 1), v));
        for (int u = 0; u < width; ++u) {
            PathCosts& above = from_above[static_cast<std::size_t>(u)];
            above = follow(u, above, left.at(u, std::max(v - 1, 0)));
            keep_winner(sums[static_cast<std::size_t>(u)], u, v, out);
        }
    }
}

}  // namespace surefoot::stereo
