// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/rig_self_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::stereo {
namespace {

constexpr double kNoise_px = 0.1;

camera::StereoRig nominal_rig() {
    camera::PinholeRadTan lens;
    lens.fx_px = 341.9;
    lens.fy_px = 342.3;
    lens.cx_px = 335.0;
    lens.cy_px = 187.0;
    camera::StereoRig rig;
    rig.left = {lens, 672, 376};
    rig.right = rig.left;
    rig.T_left_right.translation_m = {0.12, 0.0, 0.0};
    return rig;
}

/// Pixels of points in the rig `real`, rectified with the rig `believed`.
std::vector<CornerShift> corners_of(const camera::StereoRig& real,
                                    const camera::StereoRig& believed,
                                    int count,
                                    Rng& rng) {
    const auto cameras = camera::Rectifier::make(real);
    const auto rectifier = camera::Rectifier::make(believed);
    std::vector<CornerShift> corners;
    while (static_cast<int>(corners.size()) < count) {
        const double z_m = rng.uniform(0.8, 6.0);
        const Eigen::Vector3d p_m(rng.uniform(-0.9, 0.9) * z_m, rng.uniform(-0.5, 0.5) * z_m, z_m);
        const auto left_raw = cameras.value().raw_from_point(camera::Side::left, p_m);
        const auto right_raw = cameras.value().raw_from_point(camera::Side::right, p_m);
        if (!left_raw || !right_raw) continue;
        const auto left = rectifier.value().rectified_from_raw(camera::Side::left, *left_raw);
        const auto right = rectifier.value().rectified_from_raw(camera::Side::right, *right_raw);
        if (!left || !right) continue;
        corners.push_back({left->x(),
                           left->y(),
                           right->x() - left->x(),
                           right->y() - left->y() + kNoise_px * rng.normal()});
    }
    return corners;
}

camera::RectifiedRig rectified(const camera::StereoRig& rig) {
    return camera::Rectifier::make(rig).value().rig();
}

TEST(RigSelfCalibration, FindsHowTheRightEyeIsTurned) {
    const camera::StereoRig nominal = nominal_rig();
    Rng rng(3);
    for (const camera::RightCameraCorrection& this_camera :
         {camera::RightCameraCorrection{0.0009, 0.0, 0.0, 0.0006},
          camera::RightCameraCorrection{-0.002, 0.003, 0.0, -0.001},
          camera::RightCameraCorrection{0.0, -0.004, 0.0, 0.004}}) {
        const auto corners = corners_of(with_right_camera(nominal, this_camera), nominal, 600, rng);
        const auto self_calibration = estimate_self_calibration({}, rectified(nominal), corners);
        ASSERT_TRUE(self_calibration);
        EXPECT_TRUE(self_calibration->significant());
        // Half of the second order: products of the angles and the rig's half rotations.
        constexpr double kSecondOrder = 3e-5;
        EXPECT_NEAR(self_calibration->camera.roll_rad,
                    this_camera.roll_rad,
                    4.0 * self_calibration->sigma[0] + kSecondOrder);
        EXPECT_NEAR(self_calibration->camera.pitch_rad,
                    this_camera.pitch_rad,
                    4.0 * self_calibration->sigma[1] + kSecondOrder);
        EXPECT_NEAR(self_calibration->camera.focal_share,
                    this_camera.focal_share,
                    4.0 * self_calibration->sigma[2] + kSecondOrder);
        EXPECT_LT(self_calibration->row_error_left_px, 0.08);
        EXPECT_GT(self_calibration->row_error_px, self_calibration->row_error_left_px);
    }
}

/// View of a camera at `origin_m`, rotated by `rotation`: a plane that rises to the back, with
/// waves of 5 to 30 px in all directions.
GreyImage wavy_plane(const camera::PinholeRadTan& lens,
                     const Eigen::Vector3d& origin_m,
                     const Eigen::Quaterniond& rotation,
                     Rng& noise) {
    struct Wave {
        double x, y, phase;
    };
    const Eigen::Vector3d normal(0.0, 0.4, 1.0);
    constexpr double kAhead_m = 2.0;
    Rng rng(9);
    std::vector<Wave> waves;
    for (int i = 0; i < 25; ++i) {
        const double length_m = rng.uniform(5.0, 30.0) * kAhead_m / 342.0;
        const double turn_rad = rng.uniform(0.0, std::numbers::pi);
        const double k = 2.0 * std::numbers::pi / length_m;
        waves.push_back({k * std::cos(turn_rad),
                         k * std::sin(turn_rad),
                         rng.uniform(0.0, 2.0 * std::numbers::pi)});
    }
    GreyImage image(672, 376);
    for (int v = 0; v < image.height(); ++v) {
        for (int u = 0; u < image.width(); ++u) {
            const Eigen::Vector3d ray =
                rotation *
                Eigen::Vector3d((u - lens.cx_px) / lens.fx_px, (v - lens.cy_px) / lens.fy_px, 1.0);
            const double share = (kAhead_m - normal.dot(origin_m)) / normal.dot(ray);
            const Eigen::Vector3d p_m = origin_m + share * ray;
            double grey = 128.0 + 2.0 * noise.normal();
            for (const Wave& wave : waves)
                grey += 9.0 * std::sin(wave.x * p_m.x() + wave.y * p_m.y() + wave.phase);
            image.at(u, v) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
        }
    }
    return image;
}

TEST(RigSelfCalibration, FindsAllOfTheTurnInImages) {
    camera::StereoRig nominal = nominal_rig();
    nominal.rectified = true;
    const camera::RightCameraCorrection this_camera{0.0009, 0.00037, 0.0, 0.0006};
    const camera::StereoRig real = with_right_camera(nominal, this_camera);
    Rng noise(7);
    const auto lens_of = [](const camera::Camera& camera) {
        return std::get<camera::PinholeRadTan>(camera.model);
    };
    const GreyImage left = wavy_plane(
        lens_of(real.left), Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), noise);
    const GreyImage right = wavy_plane(
        lens_of(*real.right), real.T_left_right.translation_m, real.T_left_right.rotation, noise);
    const Corners corners = match_corners(left.view(), right.view(), {64, 6});
    const auto self_calibration =
        estimate_self_calibration({}, rectified(nominal), corners.matched);
    ASSERT_TRUE(self_calibration);
    // A bias toward whole pixels removes a tenth of the whole effect.
    EXPECT_NEAR(self_calibration->camera.roll_rad, this_camera.roll_rad, 0.03e-3);
    EXPECT_NEAR(self_calibration->camera.pitch_rad, this_camera.pitch_rad, 0.012e-3);
    EXPECT_NEAR(self_calibration->camera.focal_share, this_camera.focal_share, 0.05e-3);
    EXPECT_LT(self_calibration->row_error_left_px, 0.03);
}

TEST(RigSelfCalibration, AGoodRigIsLeftAlone) {
    const camera::StereoRig nominal = nominal_rig();
    int significant = 0;
    for (int seed = 0; seed < 40; ++seed) {
        Rng rng(mix_seed(4, static_cast<std::uint64_t>(seed)));
        const auto self_calibration = estimate_self_calibration(
            {}, rectified(nominal), corners_of(nominal, nominal, 400, rng));
        ASSERT_TRUE(self_calibration);
        significant += self_calibration->significant() ? 1 : 0;
        EXPECT_LT(std::abs(self_calibration->camera.focal_share), 4.0 * self_calibration->sigma[2]);
    }
    EXPECT_EQ(significant, 0);
}

TEST(RigSelfCalibration, WrongMatchesDoNotDecide) {
    const camera::StereoRig nominal = nominal_rig();
    const camera::RightCameraCorrection this_camera{0.001, -0.001, 0.0, 0.0008};
    Rng rng(5);
    auto corners = corners_of(with_right_camera(nominal, this_camera), nominal, 500, rng);
    for (std::size_t i = 0; i < corners.size(); i += 8) corners[i].rows_px = rng.uniform(2.0, 8.0);
    const auto self_calibration = estimate_self_calibration({}, rectified(nominal), corners);
    ASSERT_TRUE(self_calibration);
    // One eighth of one-sided outliers pulls Huber's mean by 1/7 of 1.5 sigma, 0.02 px, 7e-5 of f.
    EXPECT_NEAR(self_calibration->camera.pitch_rad, this_camera.pitch_rad, 1.5e-4);
    EXPECT_NEAR(self_calibration->camera.focal_share,
                this_camera.focal_share,
                4.0 * self_calibration->sigma[2] + 3e-5);
}

TEST(RigSelfCalibration, SaysNothingFromFewCornersOrFarAway) {
    const camera::StereoRig nominal = nominal_rig();
    Rng rng(6);
    EXPECT_FALSE(estimate_self_calibration({}, rectified(nominal), {}));
    EXPECT_FALSE(
        estimate_self_calibration({}, rectified(nominal), corners_of(nominal, nominal, 149, rng)));
    const camera::RightCameraCorrection knocked{0.0, 0.02, 0.0, 0.0};
    EXPECT_FALSE(estimate_self_calibration(
        {},
        rectified(nominal),
        corners_of(with_right_camera(nominal, knocked), nominal, 400, rng)));
}

}  // namespace
}  // namespace surefoot::stereo
