// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/camera_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::sim {
namespace {

TEST(CameraProfileTest, TheIdealCameraStaysAsItIs) {
    CameraConfig camera;
    camera.imaging.read_noise_dn = 1.5;
    camera.optics.smear_sigma_px = 0.4;
    apply_profile(CameraProfile::ideal, 1.0, camera);
    EXPECT_EQ(camera.imaging.read_noise_dn, 1.5);
    EXPECT_EQ(camera.imaging.noise_size_px, 0.0);
    EXPECT_EQ(camera.optics.smear_sigma_px, 0.4);
}

TEST(CameraProfileTest, VariancesAddUp) {
    CameraConfig camera;
    camera.imaging.read_noise_dn = 3.0;
    camera.optics.smear_sigma_px = 0.75;
    apply_profile(CameraProfile::zed, 1.0, camera);
    const ProfileFigures zed = figures_of(CameraProfile::zed);
    EXPECT_DOUBLE_EQ(camera.imaging.read_noise_dn, std::sqrt(9.0 + zed.noise_dn * zed.noise_dn));
    EXPECT_DOUBLE_EQ(camera.optics.smear_sigma_px,
                     std::sqrt(0.75 * 0.75 + zed.smear_sigma_px * zed.smear_sigma_px));
    EXPECT_EQ(camera.imaging.noise_size_px, zed.noise_size_px);
}

TEST(CameraProfileTest, NoiseScalesAmplitudes) {
    CameraConfig once;
    CameraConfig twice;
    twice.imaging.noise_size_px = 0.7;
    apply_profile(CameraProfile::zed, 1.0, once);
    apply_profile(CameraProfile::zed, 2.0, twice);
    EXPECT_DOUBLE_EQ(twice.imaging.read_noise_dn, 2.0 * once.imaging.read_noise_dn);
    EXPECT_DOUBLE_EQ(twice.imaging.shot_noise_dn, 4.0 * once.imaging.shot_noise_dn);
    EXPECT_EQ(twice.imaging.noise_size_px, 0.7) << "what the user chose stays";
}

TEST(CameraProfileTest, TheZedAloneIsTheSameCameraWithLessNoise) {
    const ProfileFigures alone = figures_of(CameraProfile::zed_alone);
    const ProfileFigures zed = figures_of(CameraProfile::zed);
    EXPECT_GT(alone.noise_dn, 0.0);
    EXPECT_LT(alone.noise_dn, zed.noise_dn) << "zed stands for cluttered scenes, too";
    EXPECT_EQ(alone.calibration.right_roll_rad, zed.calibration.right_roll_rad);
    EXPECT_EQ(alone.calibration.right_pitch_rad, zed.calibration.right_pitch_rad);
    EXPECT_EQ(alone.calibration.right_focal_share, zed.calibration.right_focal_share);
}

}  // namespace
}  // namespace surefoot::sim
