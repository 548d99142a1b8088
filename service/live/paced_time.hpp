// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::app {

/// Returns the time after the first frame at which a recorded frame is due, at `speed` times real
/// time. `since_first_ns`: time between the two frames in the recording. The result is limited to a
/// century in both directions, so that a sum with a clock cannot overflow; NaN gives 0.
[[nodiscard]] inline std::int64_t paced_ns(std::int64_t since_first_ns, double speed) noexcept {
    constexpr std::int64_t kCentury_ns = std::int64_t{3'155'760'000} * 1'000'000'000;
    return clamped_integer<std::int64_t>(
        static_cast<double>(since_first_ns) / speed, -kCentury_ns, kCentury_ns);
}

}  // namespace surefoot::app
