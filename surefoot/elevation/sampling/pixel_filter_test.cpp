// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/pixel_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr double kFocal_px = 342.0;
constexpr double kDepthToDisparity_px_m = 41.0;

/// Disparity of the plane n . p = h at an offset from a pixel.
float disparity_px(const Eigen::Vector3d& n, double h_m, double x, double y, double du, double dv) {
    const Eigen::Vector3d ray(x + du / kFocal_px, y + dv / kFocal_px, 1.0);
    return static_cast<float>(kDepthToDisparity_px_m * n.dot(ray) / h_m);
}

bool accepts_plane(
    const PixelFilterConfig& config, const Eigen::Vector3d& n, double h_m, double x, double y) {
    const double k = config.reach_px;
    const Neighbours around{disparity_px(n, h_m, x, y, -k, 0),
                            disparity_px(n, h_m, x, y, k, 0),
                            disparity_px(n, h_m, x, y, 0, -k),
                            disparity_px(n, h_m, x, y, 0, k)};
    return SurfaceCheck(config, kFocal_px, kFocal_px)
        .accepts(around,
                 disparity_px(n, h_m, x, y, 0, 0),
                 0.1F,
                 static_cast<float>(x),
                 static_cast<float>(y));
}

TEST(PixelFilter, RejectsPlanesExactlyBeyondTheIncidenceLimit) {
    Rng rng(9);
    const PixelFilterConfig config;
    int accepted = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double x = rng.uniform(-0.9, 0.9);
        const double y = rng.uniform(-0.5, 0.5);
        const Eigen::Vector3d ray = Eigen::Vector3d(x, y, 1.0).normalized();
        Eigen::Vector3d n(rng.normal(), rng.normal(), rng.normal());
        n.normalize();
        if (n.dot(ray) < 0.0) n = -n;
        const double incidence_deg = std::acos(n.dot(ray)) * 180.0 / std::numbers::pi;
        if (std::abs(incidence_deg - config.max_incidence_deg) < 0.05) continue;  // float rounding
        const double h_m = rng.uniform(0.3, 3.0) * n.dot(ray);
        EXPECT_EQ(accepts_plane(config, n, h_m, x, y), incidence_deg < config.max_incidence_deg)
            << "incidence " << incidence_deg << " trial " << trial;
        accepted += incidence_deg < config.max_incidence_deg ? 1 : 0;
    }
    EXPECT_GT(accepted, 500);
}

TEST(PixelFilter, LevelSurfacesMayBeSeenFlatterThanBridgesThatLean) {
    // The angle between normal and line of sight (0, 0, 1) is 83 deg: n ~ (0, b f, d).
    const float d = 17.0F;
    const double angle_rad = 83.0 * std::numbers::pi / 180.0;
    const auto step_px = static_cast<float>(3.0 * std::tan(angle_rad) / kFocal_px) * d;
    const Neighbours around{d, d, d - step_px, d + step_px};
    const Eigen::Vector3d normal(0.0, std::sin(angle_rad), std::cos(angle_rad));
    const auto accepts = [&](const Eigen::Vector3d& up_camera) {
        return SurfaceCheck({}, kFocal_px, kFocal_px, up_camera)
            .accepts(around, d, 0.1F, 0.0F, 0.0F);
    };
    EXPECT_TRUE(accepts(normal)) << "a table top";
    EXPECT_TRUE(accepts(-normal)) << "the sign of a fitted normal means nothing";
    const Eigen::AngleAxisd lean(18.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX());
    EXPECT_FALSE(accepts(lean * normal)) << "leans 18 deg";
    EXPECT_FALSE(accepts(Eigen::Vector3d::Zero())) << "gravity unknown";
}

TEST(PixelFilter, BridgesBehindLowKerbsAreNoLevelSurfaces) {
    // The surfaces tilt by 14 deg. The incidence is 72 deg, first from 32 deg above, then from 18
    // deg above, where a level surface has the same incidence.
    const float d = 25.0F;
    const auto radians = [](double deg) { return deg * std::numbers::pi / 180.0; };
    const double angle_rad = radians(72.0);
    const auto step_px = static_cast<float>(3.0 * std::tan(angle_rad) / kFocal_px) * d;
    const Neighbours around{d, d, d - step_px, d + step_px};
    const auto accepts = [&](double above_deg) {
        const Eigen::Vector3d up(0.0, std::cos(radians(above_deg)), std::sin(radians(above_deg)));
        return SurfaceCheck({}, kFocal_px, kFocal_px, up).accepts(around, d, 0.1F, 0.0F, 0.0F);
    };
    EXPECT_FALSE(accepts(32.0));
    EXPECT_TRUE(accepts(18.0));
}

TEST(PixelFilter, RejectsJumpsAndPixelsWithoutNeighbours) {
    const PixelFilterConfig config;
    const SurfaceCheck check(config, kFocal_px, kFocal_px);
    const float d = 27.0F;
    EXPECT_TRUE(check.accepts({d, d, d, d}, d, 0.1F, 0.0F, 0.0F));
    EXPECT_FALSE(check.accepts({d, d, d - 3.0F, d}, d, 0.1F, 0.0F, 0.0F)) << "depth edge above";
    EXPECT_TRUE(check.accepts({d, d, d - 0.9F, d}, d, 0.1F, 0.0F, 0.0F)) << "a bend, not a jump";
    EXPECT_FALSE(check.accepts({kNanF, kNanF, d, d}, d, 0.1F, 0.0F, 0.0F));
    EXPECT_TRUE(check.accepts({kNanF, d, d, kNanF}, d, 0.1F, 0.0F, 0.0F));
    // Middle of a matcher's ramp over 6 px between 27 and 21 px: linear, but grazing.
    EXPECT_FALSE(check.accepts({24.0F, 24.0F, 21.0F, 27.0F}, 24.0F, 0.1F, 0.0F, 0.0F));
}

TEST(PixelFilter, NoisyDisparitiesPassAsLongAsTheySaySo) {
    PixelFilterConfig config;
    config.max_incidence_deg = 80.0;  // from one side alone the bend looks like a plane at 74 deg
    const SurfaceCheck check(config, kFocal_px, kFocal_px);
    const float d = 27.0F;
    EXPECT_FALSE(check.accepts({d, d, d - 1.6F, d}, d, 0.1F, 0.0F, 0.0F));  // limit 0.7 px on 0.8
    EXPECT_TRUE(check.accepts({d, d, d - 1.6F, d}, d, 0.25F, 0.0F, 0.0F));  // limit 1.0 px
}

}  // namespace
}  // namespace surefoot::elevation
