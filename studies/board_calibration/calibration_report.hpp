// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "studies/board_calibration/calibration_run.hpp"

namespace surefoot::app {

/// Returns one self-contained HTML page. It shows board coverage, residuals, a rectified pair, the
/// cameras, their uncertainty and its effect on depth, and every rejected view with the reason.
[[nodiscard]] std::string calibration_html(const CalibrationRun& run);

}  // namespace surefoot::app
