// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/thesis_figures.hpp"
#include "apps/surefoot/thesis_map.hpp"
#include "apps/surefoot/thesis_plan.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// What all parts of the report share.
struct ThesisConditions {
    Settings settings;  ///< ours; laser: of the scans of the report
    Machine machine;
    std::uint64_t seed = 1;
    int max_frames = 0;  ///< of each recording; 0 = the whole way
    std::string folder;  ///< of the report

    [[nodiscard]] std::string scan_folder(const std::string& scene) const {
        return folder + "/scans/" + scene;
    }
    [[nodiscard]] std::string run_folder(const ThesisRun& run, ThesisColumn column) const {
        return folder + "/runs/" + run.name + "/" +
               kThesisColumnNames[static_cast<std::size_t>(column)];
    }
};

/// Scans the place of a run, measures it, and writes elevation.asc and pictures into its folder.
[[nodiscard]] Result<ThesisFigures> scan_of_run(const ThesisRun& run,
                                                const ThesisConditions& conditions,
                                                Executor& executor);

/// Makes the recording, maps it and compares it with the scan that lies in its folder; pictures go
/// into the folder of the run. Thread-safe; the same figures whatever else is running, but for
/// update_hz.
[[nodiscard]] Result<ThesisFigures> live_run(const ThesisRun& run,
                                             ThesisColumn column,
                                             const ThesisConditions& conditions);

/// The courtyard of Fig. 9.14: scanned as a whole and rated, without any recording.
[[nodiscard]] Result<ThesisFigures> scan_of_courtyard(const ThesisConditions& conditions,
                                                      Executor& executor);

}  // namespace surefoot::app
