// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "surefoot/core/assert.hpp"

namespace surefoot::eval {

/// Returns the value below which `fraction` of `sorted` lies, linear between the two nearest ranks.
[[nodiscard]] inline double percentile_of_sorted(const std::vector<double>& sorted,
                                                 double fraction) {
    SUREFOOT_ASSERT(!sorted.empty() && fraction >= 0.0 && fraction <= 1.0);
    const double rank = fraction * static_cast<double>(sorted.size() - 1);
    // in range: from 0 to the last, as asserted
    const auto below = static_cast<std::size_t>(rank);
    const auto above = std::min(below + 1, sorted.size() - 1);
    const double weight = rank - static_cast<double>(below);
    return (1.0 - weight) * sorted[below] + weight * sorted[above];
}

}  // namespace surefoot::eval
