// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/camera_profile.hpp"

#include <cmath>

namespace surefoot::sim {

ProfileFigures figures_of(CameraProfile profile) {
    switch (profile) {
        case CameraProfile::ideal: return {};
        case CameraProfile::zed:
            return {.noise_dn = 5.4,  // together with the camera's own noise of 1.0: 5.5
                    .noise_size_px = 1.3,
                    .smear_sigma_px = 1.0,
                    .contrast = 1.2,
                    .calibration = {.right_roll_rad = 0.0009,
                                    .right_pitch_rad = 0.00037,
                                    .right_focal_share = 0.0006}};
        case CameraProfile::zed_alone:
            return {.noise_dn = 0.98,  // together with the camera's own noise of 1.0: 1.4
                    .noise_size_px = 1.3,
                    .smear_sigma_px = 0.8,
                    .contrast = 1.0,
                    .calibration = figures_of(CameraProfile::zed).calibration};
        case CameraProfile::euroc:
            return {.noise_dn = 2.29,  // together with the camera's own noise of 1.0: 2.5
                    .noise_size_px = 1.6,
                    .smear_sigma_px = 1.0,
                    .contrast = 1.0,
                    .calibration = {}};
    }
    return {};
}

void apply_profile(CameraProfile profile, double noise, CameraConfig& camera) {
    const ProfileFigures figures = figures_of(profile);
    ImagingConfig& imaging = camera.imaging;
    imaging.read_noise_dn = noise * std::hypot(imaging.read_noise_dn, figures.noise_dn);
    imaging.shot_noise_dn *= noise * noise;  // shot_noise_dn is a variance
    if (imaging.noise_size_px == 0.0) imaging.noise_size_px = figures.noise_size_px;
    camera.optics.smear_sigma_px = std::hypot(camera.optics.smear_sigma_px, figures.smear_sigma_px);
}

}  // namespace surefoot::sim
