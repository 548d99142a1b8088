// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/expected_points.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace surefoot::elevation {
namespace {

/// A camera pitched down by 32 deg, turned and tilted, with its own lens.
camera::RectifiedRig tilted_rig(
    int width, int height, double fx_px, double fy_px, double cx_px, double cy_px) {
    const Eigen::Quaterniond turned =
        exp_so3({0.03, 0.0, 0.4}) * exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0});
    return {width,
            height,
            fx_px,
            fy_px,
            cx_px,
            cy_px,
            0.12,
            Pose{turned, {0.1, 0.0, 0.0}} * T_body_optical()};
}

grid::GridGeometry square(double resolution_m, const Eigen::Vector2d& origin_m) {
    grid::GridGeometry geometry;
    geometry.resolution_m = resolution_m;
    geometry.nx = 160;
    geometry.ny = 160;
    geometry.origin_m = origin_m;
    return geometry;
}

Pose standing() {
    return {Eigen::Quaterniond::Identity(), {2.0, 1.0, 1.1}};
}

TEST(ExpectedPoints, AreThePixelsWhoseRaysMeetTheCell) {
    const camera::RectifiedRig rig = tilted_rig(2688, 1504, 1400.0, 1300.0, 1340.0, 750.0);
    const Pose T_odom_body = standing();
    const grid::GridGeometry geometry = square(0.025, {2.0, -0.5});
    constexpr double kGround_m = 0.05;

    Image<int> met(geometry.nx, geometry.ny, 0);
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray =
                T_odom_camera.R() *
                Eigen::Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const double way = (kGround_m - T_odom_camera.translation_m.z()) / ray.z();
            if (way <= 0.0) continue;
            const Eigen::Vector3d p_m = T_odom_camera.translation_m + way * ray;
            if (const auto cell = geometry.cell_at(p_m.x(), p_m.y())) ++met.at(cell->ix, cell->iy);
        }
    }
    const ExpectedPoints expected(rig, T_odom_body, geometry);
    int compared = 0;
    for (const auto& [ix, iy] : {std::pair{40, 40}, {60, 80}, {90, 100}, {30, 70}, {120, 120}}) {
        const int pixels = met.at(ix, iy);
        if (pixels < 100) continue;
        ++compared;
        // Pixels on the border of a cell are in or out by chance: four sides of sqrt(n) pixels,
        // half of them in.
        EXPECT_NEAR(expected.at(ix, iy, static_cast<float>(kGround_m)),
                    pixels,
                    2.0 * std::sqrt(static_cast<double>(pixels)))
            << ix << ", " << iy;
    }
    EXPECT_GE(compared, 3);
}

TEST(ExpectedPoints, TellsWhichCellsBothEyesSeeWhole) {
    const camera::RectifiedRig rig = tilted_rig(672, 376, 340.0, 330.0, 330.0, 190.0);
    const Pose T_odom_body = standing();
    const grid::GridGeometry geometry = square(0.05, {-1.0, -3.0});
    constexpr float kGround_m = 0.05F;
    const ExpectedPoints expected(rig, T_odom_body, geometry);
    const Pose T_camera_odom = (T_odom_body * rig.T_body_camera).inverse();
    // The middle and twelve points around it.
    const auto seen_around = [&](const Eigen::Vector2d& middle_m, double radius_m) {
        int seen = 0;
        for (int i = 0; i < 13; ++i) {
            const double angle = std::numbers::pi / 6.0 * i;
            const double reach_m = i == 12 ? 0.0 : radius_m;
            const Eigen::Vector3d p_m =
                T_camera_odom * Eigen::Vector3d(middle_m.x() + reach_m * std::cos(angle),
                                                middle_m.y() + reach_m * std::sin(angle),
                                                static_cast<double>(kGround_m));
            const double u_px = rig.fx_px * p_m.x() / p_m.z() + rig.cx_px;
            const double v_px = rig.fy_px * p_m.y() / p_m.z() + rig.cy_px;
            const double u_right_px = u_px - rig.fx_px * rig.baseline_m / p_m.z();
            seen += p_m.z() > 0.0 && u_right_px >= -0.5 && u_px <= rig.width - 0.5 &&
                    v_px >= -0.5 && v_px <= rig.height - 0.5;
        }
        return seen;
    };
    int whole = 0;
    int partial = 0;
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const Eigen::Vector2d middle_m = geometry.center_m({ix, iy});
            if (expected.is_whole_in_view(ix, iy, kGround_m)) {
                ++whole;
                ASSERT_EQ(seen_around(middle_m, 0.0353), 13) << ix << ", " << iy;
            } else {
                // The ball is larger than the cell at a slant.
                const int seen = seen_around(middle_m, 0.11);
                ASSERT_LT(seen, 13) << ix << ", " << iy;
                partial += seen > 0;
            }
        }
    }
    EXPECT_GT(whole, 1000);
    EXPECT_GT(partial, 100);
}

TEST(ExpectedPoints, NoneBehindOrAboveTheCamera) {
    camera::RectifiedRig rig;
    rig.fx_px = 300.0;
    rig.fy_px = 300.0;
    rig.T_body_camera = T_body_optical();
    grid::GridGeometry geometry;
    geometry.nx = 10;
    geometry.ny = 10;
    geometry.origin_m = {-2.0, 0.0};
    const Pose T_odom_body{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
    EXPECT_EQ(ExpectedPoints(rig, T_odom_body, geometry).at(0, 0, 0.0F), 0.0F);
    geometry.origin_m = {2.0, 0.0};
    EXPECT_GT(ExpectedPoints(rig, T_odom_body, geometry).at(0, 0, 0.0F), 0.0F);
    EXPECT_EQ(ExpectedPoints(rig, T_odom_body, geometry).at(0, 0, 1.5F), 0.0F);
}

}  // namespace
}  // namespace surefoot::elevation
