// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/surefoot/suite_case.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// A case that is to be run, and about how many frames it has: the measure of how long it takes.
struct PlannedCase {
    SuiteCase which;
    int frames = 0;
};

/// Every case of the choice, in the order in which they are run: seed by seed, so that a suite that
/// is stopped has seen every scene; within a seed the long ones first, so that no thread waits long
/// for another at the end. Impossible choices are usage errors.
///
/// A walking machine takes 10 s a step and hardly moves from frame to frame: its camera runs at
/// 4 Hz at most, and in the quick suite it takes the first steps only.
[[nodiscard]] Result<std::vector<PlannedCase>> plan_suite(const EvalSuiteOptions& options,
                                                          const Settings& settings);

}  // namespace surefoot::app
