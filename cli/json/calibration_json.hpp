// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "studies/board_calibration/calibration_run.hpp"

namespace surefoot::app {

/// Returns the JSON result of `calibrate`: rms, cameras with sigmas, rejected views, advice.
[[nodiscard]] std::string calibration_json(const CalibrationRun& run);
/// Returns the content of views.json, for other tools: every board point of every view.
[[nodiscard]] std::string views_json(const CalibrationRun& run);

}  // namespace surefoot::app
