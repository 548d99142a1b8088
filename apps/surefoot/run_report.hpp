// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/surefoot/run_output.hpp"

namespace surefoot::app {

/// elevation.png, traversability.png and the self-contained report.html.
[[nodiscard]] Status write_pictures_and_report(const RunOptions& options,
                                               const Settings& settings,
                                               const std::optional<io::MachineFile>& machine,
                                               const pipeline::Pipeline& pipeline,
                                               const RunRecord& record);

}  // namespace surefoot::app
