// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace surefoot::stairs {

/// The median; for an even count the greater middle value. Reorders `values`, which is not empty.
template <typename T>
[[nodiscard]] T middle_of(std::vector<T>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Robust standard deviation (normal errors): 1.4826 times the median distance from `middle`.
/// Overwrites `values` with these distances. Precondition: `values` is not empty.
template <typename T>
[[nodiscard]] double scatter_about(T middle, std::vector<T>& values) {
    constexpr double kSigmaPerMedian = 1.4826;
    for (T& value : values) value = std::abs(value - middle);
    return kSigmaPerMedian * static_cast<double>(middle_of(values));
}

}  // namespace surefoot::stairs
