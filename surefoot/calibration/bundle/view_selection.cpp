// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/view_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace surefoot::calibration {
namespace {

using Motion = std::function<double(std::size_t, std::size_t)>;

std::vector<std::size_t> without_repeats(std::span<const std::size_t> candidates,
                                         const Motion& motion_px,
                                         double least_px,
                                         std::vector<RejectedView>& rejected) {
    std::vector<std::size_t> kept;
    for (const std::size_t i : candidates) {
        const auto twin = std::find_if(kept.begin(), kept.end(), [&](std::size_t k) {
            return !(motion_px(k, i) >= least_px);
        });
        if (twin == kept.end()) {
            kept.push_back(i);
            continue;
        }
        reject(
            rejected,
            i,
            fmt::format("almost the same as view {}: the corners moved by {:.2f} px, but at least "
                        "{:.2f} px are needed",
                        *twin,
                        motion_px(*twin, i),
                        least_px));
    }
    return kept;
}

}  // namespace

std::vector<std::size_t> select_views(std::span<const std::size_t> candidates,
                                      const Motion& motion_px,
                                      const SelectionLimits& limits,
                                      std::vector<RejectedView>& rejected) {
    std::vector<std::size_t> different =
        without_repeats(candidates, motion_px, limits.least_motion_px, rejected);
    if (different.size() <= limits.most_views) return different;
    std::vector<double> apart(different.size(), std::numeric_limits<double>::infinity());
    std::vector<bool> taken(different.size(), false);
    std::size_t next = 0;
    for (std::size_t n = 0; n < limits.most_views; ++n) {
        taken[next] = true;
        for (std::size_t i = 0; i < different.size(); ++i) {
            apart[i] =
                taken[i] ? -1.0 : std::min(apart[i], motion_px(different[next], different[i]));
        }
        next =
            static_cast<std::size_t>(std::max_element(apart.begin(), apart.end()) - apart.begin());
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < different.size(); ++i) {
        if (taken[i])
            kept.push_back(different[i]);
        else
            reject(rejected,
                   different[i],
                   fmt::format("not needed: the calibration uses the {} views that differ most",
                               limits.most_views));
    }
    return kept;
}

}  // namespace surefoot::calibration
