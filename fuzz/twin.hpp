// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/targets.h>

#include <bit>
#include <cstdint>

#include "surefoot/core/executors_testing.hpp"

/// How a second computation differs from the first that must have the same bytes.
namespace surefoot::fuzz {

/// Holds the dispatch of Highway on one of the instruction sets while it lives.
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
    /// Asked once: the processor takes its time to answer.
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
