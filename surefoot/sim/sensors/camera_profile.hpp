// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/calibration_error.hpp"

namespace surefoot::sim {

/// Camera models that were compared with real recordings, and an ideal one.
enum class CameraProfile : std::uint8_t { ideal, zed, euroc, zed_alone };
inline constexpr const char* kCameraProfileNames[] = {"ideal", "zed", "euroc", "zed_alone"};

/// Errors of a real camera beyond those of the ideal one. The figures are frozen: fitted to
/// `zed_office` and `euroc_still` by `tools/experiments camera_fit` (docs/lab/reality_gap.md). The
/// rotation of the ZED's right camera was measured on corners of the same recording. `zed_alone`
/// has the errors of the ZED only. In a clutter scene like the recording, its disparity noise is
/// that of the recording for the seeds of the fit, and a quarter larger for other seeds. `zed` is
/// for plain scenes and has more noise, fitted to OpenCV's matcher (our matcher agrees with the
/// recording at twice that noise). `zed` is the harsher profile; use it for claims.
struct ProfileFigures {
    double noise_dn = 0.0;       ///< noise in addition to the noise of the camera
    double noise_size_px = 0.0;  ///< replaces the noise size of the camera if that size is 0
    double smear_sigma_px = 0.0;
    double contrast = 1.0;
    CalibrationError calibration;
};
[[nodiscard]] ProfileFigures figures_of(CameraProfile profile);

/// Adds the profile to a camera: variances add up. `noise` multiplies all noise amplitudes, the
/// camera's own included.
void apply_profile(CameraProfile profile, double noise, CameraConfig& camera);

}  // namespace surefoot::sim
