// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/surefoot/calibration_run.hpp"

namespace surefoot::app {

/// One self-contained page: where the board was seen, residuals, a rectified pair, the cameras with
/// their uncertainty and what that means for depth, and every view that was left out, with why.
[[nodiscard]] std::string calibration_html(const CalibrationRun& run);

}  // namespace surefoot::app
