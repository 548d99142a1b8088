// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/sensors/calibration_error.hpp"

namespace surefoot::sim {

/// Cameras whose images have been compared with real recordings, and one without faults.
enum class CameraProfile : std::uint8_t { ideal, zed, euroc, zed_alone };
inline constexpr const char* kCameraProfileNames[] = {"ideal", "zed", "euroc", "zed_alone"};

/// What a real camera does beyond the ideal one. The figures are frozen: fitted to `zed_office` and
/// `euroc_still` by `tools/experiments camera_fit`, see docs/lab/reality_gap.md; the turn
/// of the ZED's right eye was measured on corners of the same recording. `zed_alone` is
/// that camera and nothing else: before a heap of things as in its recording it scatters as the
/// recording does on the seeds of the fit, a quarter more on others. `zed` stands before plain
/// scenes and has the rest as noise (fitted to what OpenCV's matcher makes of it; our own agrees
/// with the recording at twice that noise): the harsher one, and the one for claims.
struct ProfileFigures {
    double noise_dn = 0.0;       ///< on top of the camera's own
    double noise_size_px = 0.0;  ///< instead of the camera's own where it has none
    double smear_sigma_px = 0.0;
    double contrast = 1.0;
    CalibrationError calibration;
};
[[nodiscard]] ProfileFigures figures_of(CameraProfile profile);

/// Adds the profile to a camera: variances add up. `noise` is a factor on all its noise amplitudes,
/// the camera's own included.
void apply_profile(CameraProfile profile, double noise, CameraConfig& camera);

}  // namespace surefoot::sim
