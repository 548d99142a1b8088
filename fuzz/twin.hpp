// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/targets.h>

#include <bit>
#include <cstdint>

#include "surefoot/core/executors_testing.hpp"

/// Tools to run a computation a second time in another way; both runs must give the same bytes.
namespace surefoot::fuzz {

/// Restricts Highway's dispatch to one supported instruction set during its lifetime. Process-wide:
/// not thread-safe. `which` selects the set, modulo their number.
class OnTarget {
  public:
    explicit OnTarget(int which) {
        std::int64_t left = all();
        for (int i = which % std::popcount(static_cast<std::uint64_t>(left)); i > 0; --i)
            left &= left - 1;
        hold(left & -left);
    }
    ~OnTarget() { hold(all()); }
    OnTarget(const OnTarget&) = delete;
    OnTarget& operator=(const OnTarget&) = delete;

  private:
    /// Cached, because the query of the processor is slow.
    static std::int64_t all() {
        static const std::int64_t targets = hwy::SupportedTargets();
        return targets;
    }
    static void hold(std::int64_t target) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
};

}  // namespace surefoot::fuzz
