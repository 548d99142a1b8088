// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "studies/runs/run_output.hpp"
#include "surefoot/eval/maps/map_view.hpp"

namespace surefoot::app {

/// Returns the overlays for the map pictures of a run: the path, the final pose of the body, and
/// the feet if there is a machine file.
[[nodiscard]] eval::Overlays overlays_of(const std::optional<io::MachineFile>& machine,
                                         const RunRecord& record);

/// Writes elevation.png, traversability.png, stairs.png, classes.png and the self-contained
/// report.html.
[[nodiscard]] Status write_pictures_and_report(const RunOptions& options,
                                               const Settings& settings,
                                               const std::optional<io::MachineFile>& machine,
                                               const pipeline::Pipeline& pipeline,
                                               const RunRecord& record);

}  // namespace surefoot::app
