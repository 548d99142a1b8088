// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/calibration_error.hpp"

namespace surefoot::sim {

/// Camera models that were compared with real recordings, and an ideal one.
enum class CameraProfile : std::uint8_t { ideal, zed, euroc, zed_alone };
inline constexpr const char* kCameraProfileNames[] = {"ideal", "zed", "euroc", "zed_alone"};

/// Errors of a real camera beyond the ideal one. The figures are frozen: fitted to `zed_office` and
/// `euroc_still` by `tools/experiments camera_fit`, see docs/lab/reality_gap.md. The rotation of
/// the ZED's right camera was measured on corners of the same recording. `zed_alone` is that camera
/// alone: in a clutter scene like its recording it scatters as the recording does on the fit's
/// seeds, a quarter more on others. `zed` is for plain scenes and has the rest as noise, fitted to
/// OpenCV's matcher (our matcher agrees with the recording at twice that noise). `zed` is the
/// harsher profile; use it for claims.
struct ProfileFigures {
    double noise_dn = 0.0;       ///< noise in addition to the noise of the camera
    double noise_size_px = 0.0;  ///< replaces the camera's own size if that is 0
    double smear_sigma_px = 0.0;
    double contrast = 1.0;
    CalibrationError calibration;
};
[[nodiscard]] ProfileFigures figures_of(CameraProfile profile);

/// Adds the profile to a camera: variances add up. `noise` multiplies all noise amplitudes, the
/// camera's own included.
void apply_profile(CameraProfile profile, double noise, CameraConfig& camera);

}  // namespace surefoot::sim
