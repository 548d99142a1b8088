// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/checked_index.hpp"

namespace surefoot {

/// Time stamps are int64 nanoseconds. Durations may be doubles in seconds (`_s`).
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

[[nodiscard]] constexpr double seconds_from_ns(std::int64_t time_ns) noexcept {
    return static_cast<double>(time_ns) * 1e-9;
}
/// Rounds to the nearest nanosecond. Limits the result to +-146 years, so that the sum of two
/// results fits. NaN gives 0.
[[nodiscard]] constexpr std::int64_t ns_from_seconds(double time_s) noexcept {
    const double scaled = time_s * 1e9;
    constexpr std::int64_t kMost_ns = (std::int64_t{1} << 62) - 1;
    const auto time_ns =
        saturated_integer<std::int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
    return time_ns > kMost_ns ? kMost_ns : time_ns < -kMost_ns ? -kMost_ns : time_ns;
}

}  // namespace surefoot
