// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "io/machine_file.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// One run of the suite: a scene as its seed varies it, seen with a multiple of the nominal noise.
struct SuiteCase {
    std::string scene;
    std::uint64_t seed = 1;
    double noise = 1.0;  ///< factor on the camera's noise amplitudes
    int max_frames = 0;  ///< 0 = the whole path

    /// "demo_stairs/seed 3/noise 2": what a finished case is known by.
    [[nodiscard]] std::string name() const;
};

/// What is measured in every case, in the order of `SuiteResult::figures`. `lower_is_better` says
/// which end of a figure is its worst case.
struct SuiteFigure {
    const char* name;
    const char* unit;
    bool lower_is_better;
    const char* meaning;
};
[[nodiscard]] const std::vector<SuiteFigure>& suite_figures();

struct SuiteResult {
    SuiteCase which;
    std::vector<double> figures;  ///< one per suite_figures(); NaN = there was nothing to measure
};

/// Simulates the case, runs the whole chain over it and compares with the truth; nothing is
/// aligned.
[[nodiscard]] Result<SuiteResult> run_suite_case(const SuiteCase& which,
                                                 const Settings& settings,
                                                 const io::MachineFile& machine,
                                                 Executor& executor,
                                                 const std::string& progress_label);

}  // namespace surefoot::app
