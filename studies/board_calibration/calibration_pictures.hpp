// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "studies/board_calibration/calibration_run.hpp"
#include "surefoot/eval/report/canvas.hpp"

namespace surefoot::app {

/// Draws the board points of all views in the image plane. The colours distinguish used views from
/// views that were left out. Stripes mark parts of the image without any point.
[[nodiscard]] eval::Picture coverage_picture(const CalibrationRun& run, int camera);
/// Draws the tilt of the board in each view and which side of the board was nearer. Stripes mark
/// sides for which no view is tilted enough.
[[nodiscard]] eval::Picture tilt_picture(const CalibrationRun& run, int camera);
/// Draws the residual (measured minus predicted pixel) of every point of the used views. Outliers
/// have another colour. The residuals are enlarged: an arrow of 20 px is their 95th percentile.
[[nodiscard]] eval::Picture residual_picture(const CalibrationRun& run,
                                             const CalibratedCamera& this_camera);
/// Draws the sample pair side by side, rectified with the calibration. Corresponding points must
/// lie on the same horizontal line. Empty for one camera.
[[nodiscard]] eval::Picture epipolar_picture(const CalibrationRun& run);

}  // namespace surefoot::app
