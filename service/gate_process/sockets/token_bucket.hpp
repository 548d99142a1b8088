// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "surefoot/core/time.hpp"

namespace surefoot::gate_process {

/// Rate limit: `burst` events at once, `per_s` on average.
struct RateLimit {
    std::int64_t per_s = 1;
    std::int64_t burst = 1;
};

/// A token bucket in whole nanoseconds. It stores the time at which the bucket will be full; every
/// token moves that time by one interval. A refused event takes no token.
class TokenBucket {
  public:
    /// Precondition: both numbers of the limit are positive.
    explicit TokenBucket(RateLimit limit) noexcept
        : interval_ns_(std::max<std::int64_t>(1, kNanosecondsPerSecond / limit.per_s)),
          depth_ns_(interval_ns_ * limit.burst) {}

    [[nodiscard]] bool take(std::int64_t now_ns) noexcept {
        const std::int64_t full_ns = std::max(full_ns_, now_ns) + interval_ns_;
        if (full_ns - now_ns > depth_ns_) return false;
        full_ns_ = full_ns;
        return true;
    }

  private:
    std::int64_t interval_ns_;
    std::int64_t depth_ns_;
    std::int64_t full_ns_ = 0;
};

}  // namespace surefoot::gate_process
