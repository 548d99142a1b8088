// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace surefoot {

/// Returns the median; for an even number of values, the greater of the two middle values. Reorders
/// `values`, which must not be empty. O(n).
template <typename T>
[[nodiscard]] T upper_median_in_place(std::vector<T>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Returns the median of a copy, so that the caller's values keep their order.
template <typename T>
[[nodiscard]] T upper_median(std::vector<T> values) {
    return upper_median_in_place(values);
}

/// Estimates the standard deviation about `middle`; a few outliers hardly change the estimate. It
/// is 1.4826 times the median distance, which is right for a normal distribution. Replaces `values`
/// by their distances. `values` must not be empty.
template <typename T>
[[nodiscard]] double robust_sigma_about(T middle, std::vector<T>& values) {
    constexpr double kSigmaPerMedian = 1.4826;
    for (T& value : values) value = std::abs(value - middle);
    return kSigmaPerMedian * static_cast<double>(upper_median_in_place(values));
}

}  // namespace surefoot
