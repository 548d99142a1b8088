// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/depth_design.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace surefoot::eval {
namespace {

/// Height of the point that a floor pixel shows when its disparity is off, by plain geometry: the
/// camera at height H, pitched; the ray to the floor at range R; depth f b / (d + off).
double height_of_wrong_floor_m(const DepthDesign& design, double range_m, double off_px) {
    const double pitch = design.pitch_deg * std::numbers::pi / 180.0;
    const Eigen::Vector2d axis(std::cos(pitch), -std::sin(pitch));
    const Eigen::Vector2d ray(range_m, -design.camera_height_m);
    const double depth_m = ray.dot(axis);
    const double fb = design.focal_px * design.baseline_m;
    const double wrong_m = fb / (fb / depth_m + off_px);
    return design.camera_height_m + ray.y() * wrong_m / depth_m;
}

TEST(DepthDesign, NoiseLimitIsTheHeightOfAWrongFloorPoint) {
    const DepthDesign design;
    for (const double range_m : {0.6, 1.0, 2.0, 4.0}) {
        const ResolvableHeight found = resolvable_height(design, range_m);
        const double step_px = 1e-5;
        const double slope_m_px = height_of_wrong_floor_m(design, range_m, step_px) / step_px;
        EXPECT_NEAR(found.noise_limit_m,
                    3.0 * std::numbers::sqrt2 * slope_m_px * design.sigma_px,
                    1e-5 * found.noise_limit_m + 1e-9)
            << range_m;
    }
}

TEST(DepthDesign, PixelLimitIsThreeRows) {
    const DepthDesign design;
    const double range_m = 1.5;
    const ResolvableHeight found = resolvable_height(design, range_m);
    const double angle_rad = std::atan2(design.camera_height_m, range_m) -
                             std::atan2(design.camera_height_m - found.pixel_limit_m, range_m);
    EXPECT_NEAR(angle_rad * design.focal_px, 3.0, 0.03);  // the angle is not quite proportional
}

TEST(DepthDesign, LongerBaselineAndFocalLengthResolveMore) {
    const DepthDesign design;
    DepthDesign wide = design;
    wide.baseline_m *= 2.0;
    EXPECT_NEAR(resolvable_height(wide, 2.0).noise_limit_m,
                0.5 * resolvable_height(design, 2.0).noise_limit_m,
                1e-12);
    DepthDesign fine = design;
    fine.focal_px *= 2.0;
    EXPECT_NEAR(resolvable_height(fine, 2.0).height_m,
                0.5 * resolvable_height(design, 2.0).height_m,
                1e-12);
}

TEST(DepthDesign, NearestFloorOfTheMachine) {
    // 0.95 m high, 32 deg down, f = 342 px: 0.53 m ahead (system facts of the machine).
    DepthDesign design;
    design.camera_height_m = 0.95;
    EXPECT_NEAR(nearest_floor_m(design), 0.53, 0.005);
    EXPECT_FALSE(resolvable_height(design, 0.5).in_view);
    EXPECT_TRUE(resolvable_height(design, 0.56).in_view);
}

TEST(DepthDesign, SaysWhatIsImpossible) {
    DepthDesign design;
    EXPECT_FALSE(design.problem());
    design.baseline_m = 0.0;
    EXPECT_EQ(design.problem().value_or(""), "--baseline [m] = 0 must be between 0.001 and 10");
    design = {};
    design.sigma_px = std::nan("");
    EXPECT_TRUE(design.problem());
}

}  // namespace
}  // namespace surefoot::eval
