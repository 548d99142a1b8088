// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::app {

/// How long after the first frame of a recording another one is due that was taken `since_first_ns`
/// after it, at `speed` times real time. At most a century to either side, so that the sum with a
/// clock fits; NaN gives 0.
[[nodiscard]] inline std::int64_t paced_ns(std::int64_t since_first_ns, double speed) noexcept {
    constexpr std::int64_t kCentury_ns = std::int64_t{3'155'760'000} * 1'000'000'000;
    return std::clamp(saturated_integer<std::int64_t>(static_cast<double>(since_first_ns) / speed),
                      -kCentury_ns,
                      kCentury_ns);
}

}  // namespace surefoot::app
