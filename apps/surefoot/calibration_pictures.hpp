// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/surefoot/calibration_run.hpp"
#include "surefoot/eval/report/canvas.hpp"

namespace surefoot::app {

/// Where in the image the points of all views lay: used, and left out; parts of the image that no
/// point reached are striped.
[[nodiscard]] eval::Picture coverage_picture(const CalibrationRun& run, int camera);
/// By how much the board was tilted in each view and which of its sides came nearer; sides that no
/// view tilted enough are striped.
[[nodiscard]] eval::Picture tilt_picture(const CalibrationRun& run, int camera);
/// Measured minus predicted place of every point used, enlarged so that the 95th percentile is
/// clearly visible.
[[nodiscard]] eval::Picture residual_picture(const CalibrationRun& run, const CalibratedEye& eye);
/// The sample pair rectified by the result, side by side, with lines along which both eyes must
/// show the same things; empty for one camera.
[[nodiscard]] eval::Picture epipolar_picture(const CalibrationRun& run);

}  // namespace surefoot::app
