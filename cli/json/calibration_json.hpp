// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "studies/board_calibration/calibration_run.hpp"

namespace surefoot::app {

/// The result of `calibrate` as JSON for stdout: rms, cameras with sigmas, rejected views, advice.
[[nodiscard]] std::string calibration_json(const CalibrationRun& run);
/// Content of views.json: every board point of every view, for other tools.
[[nodiscard]] std::string views_json(const CalibrationRun& run);

}  // namespace surefoot::app
