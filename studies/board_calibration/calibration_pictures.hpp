// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "studies/board_calibration/calibration_run.hpp"
#include "surefoot/eval/report/canvas.hpp"

namespace surefoot::app {

/// Draws the board points of all views in the image plane, used points and left-out points in
/// different colours. Stripes mark parts of the image without any point.
[[nodiscard]] eval::Picture coverage_picture(const CalibrationRun& run, int camera);
/// Draws how far the board was tilted in each view and which of its sides was nearer. Stripes mark
/// sides for which no view is tilted enough.
[[nodiscard]] eval::Picture tilt_picture(const CalibrationRun& run, int camera);
/// Draws the residual (measured minus predicted pixel) of every point used, enlarged so that the
/// 95th percentile is clearly visible.
[[nodiscard]] eval::Picture residual_picture(const CalibrationRun& run,
                                             const CalibratedCamera& this_camera);
/// Draws the sample pair, rectified by the result, side by side. Corresponding points must lie on
/// the same horizontal line. Empty for one camera.
[[nodiscard]] eval::Picture epipolar_picture(const CalibrationRun& run);

}  // namespace surefoot::app
