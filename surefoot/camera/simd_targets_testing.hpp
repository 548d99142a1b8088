// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/targets.h>

#include <functional>

/// Runs SIMD code under every instruction set of this processor.
namespace surefoot::camera::test {

/// Calls `check(name)` with Highway's dispatch fixed to each target in turn, the slowest last.
inline void on_every_target(const std::function<void(const char*)>& check) {
    const std::int64_t all = hwy::SupportedTargets();
    for (std::int64_t left = all; left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        check(hwy::TargetName(target));
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace surefoot::camera::test
