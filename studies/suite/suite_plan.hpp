// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "studies/suite/suite_case.hpp"
#include "studies/suite/suite_options.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// A case to run, and its approximate number of frames, which estimates the run time.
struct PlannedCase {
    SuiteCase which;
    int frames = 0;
};

/// Returns all selected cases in the order in which they run. The order is by seed, so that every
/// scene has run before the second seed begins. Within a seed long cases run first, so that threads
/// finish at about the same time. An unknown or repeated name is a usage error.
///
/// A walking machine takes 10 s for a step and moves little from frame to frame. Its camera
/// therefore runs at 4 Hz at most, and the quick suite covers only its first steps.
[[nodiscard]] Result<std::vector<PlannedCase>> plan_suite(const EvalSuiteOptions& options,
                                                          const Settings& settings);

}  // namespace surefoot::app
