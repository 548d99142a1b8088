// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/surefoot/run_output.hpp"
#include "surefoot/eval/maps/map_view.hpp"

namespace surefoot::app {

/// What is drawn over the maps of a run: the way, the body at its end, the feet of a machine.
[[nodiscard]] eval::Overlays overlays_of(const std::optional<io::MachineFile>& machine,
                                         const RunRecord& record);

/// elevation.png, traversability.png, stairs.png, classes.png and the self-contained report.html.
[[nodiscard]] Status write_pictures_and_report(const RunOptions& options,
                                               const Settings& settings,
                                               const std::optional<io::MachineFile>& machine,
                                               const pipeline::Pipeline& pipeline,
                                               const RunRecord& record);

}  // namespace surefoot::app
