// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/expected_points.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace surefoot::elevation {
namespace {

TEST(ExpectedPoints, AreThePixelsWhoseRaysMeetTheCell) {
    camera::RectifiedRig rig;
    rig.width = 2688;
    rig.height = 1504;
    rig.fx_px = 1400.0;
    rig.fy_px = 1300.0;
    rig.cx_px = 1340.0;
    rig.cy_px = 750.0;
    rig.baseline_m = 0.12;
    const Eigen::Quaterniond turned =
        exp_so3({0.03, 0.0, 0.4}) * exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0});
    rig.T_body_camera = Pose{turned, {0.1, 0.0, 0.0}} * T_body_optical();
    const Pose T_odom_body{Eigen::Quaterniond::Identity(), {2.0, 1.0, 1.1}};
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.025;
    geometry.nx = 160;
    geometry.ny = 160;
    geometry.origin_m = {2.0, -0.5};
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
        // Pixels on the border of a cell, in or out: four sides of sqrt(n), half of them by chance.
        EXPECT_NEAR(expected.at(ix, iy, static_cast<float>(kGround_m)),
                    pixels,
                    2.0 * std::sqrt(static_cast<double>(pixels)))
            << ix << ", " << iy;
    }
    EXPECT_GE(compared, 3);
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
