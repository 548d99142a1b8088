// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace surefoot::stairs {

/// The middle one of values that may be reordered, of two in the middle the greater; not empty.
template <typename T>
[[nodiscard]] T middle_of(std::vector<T>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace surefoot::stairs
