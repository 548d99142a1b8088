// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "service/console/option_settings.hpp"
#include "studies/lange2016/thesis_figures.hpp"
#include "studies/lange2016/thesis_map.hpp"
#include "studies/lange2016/thesis_plan.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Conditions that all parts of the report on the reference thesis (Lange 2016) share.
struct ThesisConditions {
    Settings settings;  ///< settings of the column "ours"; `laser` is for the scans
    Machine machine;
    std::uint64_t seed = 1;
    int max_frames = 0;  ///< largest number of frames; 0 = the whole path
    std::string folder;  ///< folder of the report

    [[nodiscard]] std::string scan_folder(const std::string& scene) const {
        return folder + "/scans/" + scene;
    }
    [[nodiscard]] std::string run_folder(const ThesisRun& run, ThesisColumn column) const {
        return folder + "/runs/" + run.name + "/" +
               kThesisColumnNames[static_cast<std::size_t>(column)];
    }
};

/// Scans the scene of a run, measures the scan, and writes elevation.asc and pictures to
/// scan_folder().
[[nodiscard]] Result<ThesisFigures> scan_of_run(const ThesisRun& run,
                                                const ThesisConditions& conditions,
                                                Executor& executor);

/// Simulates the recording, maps it and compares the map with the scan in scan_folder().
/// Writes pictures to run_folder(). Thread-safe. Other threads affect only the figure
/// update_hz.
[[nodiscard]] Result<ThesisFigures> live_run(const ThesisRun& run,
                                             ThesisColumn column,
                                             const ThesisConditions& conditions);

/// The courtyard of Fig. 9.14 of the reference thesis: one rated scan of the whole place, without a
/// recording.
[[nodiscard]] Result<ThesisFigures> scan_of_courtyard(const ThesisConditions& conditions,
                                                      Executor& executor);

}  // namespace surefoot::app
