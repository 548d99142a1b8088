// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/reproject.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "surefoot/camera/simd_targets_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::camera {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

RectifiedRig rig_of(int width, int height) {
    RectifiedRig rig;
    rig.width = width;
    rig.height = height;
    rig.fx_px = 342.7;
    rig.fy_px = 341.3;
    rig.cx_px = 0.5 * width + 3.3;
    rig.cy_px = 0.5 * height - 1.7;
    rig.baseline_m = 0.12;
    return rig;
}

/// Four roundings: the ray, the focal length times the baseline, the quotient, the product.
constexpr double kUlps = 4.0 * 0x1p-24;

TEST(Reproject, EveryTargetGivesTheExactPoint) {
    Rng rng(11);
    for (const int width : {1, 3, 16, 17, 67}) {
        const RectifiedRig rig = rig_of(width, 5);
        Image<float> disparity_px(width, 5);
        for (std::size_t i = 0; i < disparity_px.size(); ++i)
            disparity_px.data()[i] = static_cast<float>(rng.uniform(0.05, 300.0));
        const Reprojector reprojector(rig);
        Image<Eigen::Vector3f> first;
        test::on_every_target([&](const char* target) {
            Image<Eigen::Vector3f> points_m;
            reprojector.points(disparity_px.view(), points_m);
            ASSERT_EQ(points_m.size(), disparity_px.size());
            for (int v = 0; v < 5; ++v) {
                for (int u = 0; u < width; ++u) {
                    const Eigen::Vector3d exact = rig.point(u, v, disparity_px.at(u, v));
                    for (int axis = 0; axis < 3; ++axis) {
                        ASSERT_NEAR(
                            points_m.at(u, v)[axis], exact[axis], kUlps * std::abs(exact[axis]))
                            << target << " " << u << " " << v << " axis " << axis;
                    }
                }
            }
            if (first.empty()) first = points_m;
            EXPECT_EQ(std::memcmp(first.data(), points_m.data(), 12 * points_m.size()), 0)
                << target;
        });
    }
}

TEST(Reproject, WhatIsNoDistanceIsUnknown) {
    const float strange[] = {kNanF, kInfinity, -kInfinity, 0.0F, -0.0F, -3.0F, 1e-45F};
    constexpr int kWidth = 40;  // whole vectors; with 16 lanes also a remainder
    for (const float value : strange) {
        const Image<float> disparity_px(kWidth, 1, value);
        test::on_every_target([&](const char* target) {
            Image<Eigen::Vector3f> points_m;
            Reprojector(rig_of(kWidth, 1)).points(disparity_px.view(), points_m);
            for (int u = 0; u < kWidth; ++u)
                EXPECT_TRUE(points_m.at(u, 0).array().isNaN().all()) << target << " " << value;
        });
    }
}

TEST(Reproject, EmptyImage) {
    Image<Eigen::Vector3f> points_m(3, 3, Eigen::Vector3f::Zero());
    Reprojector(rig_of(0, 0)).points(Image<float>().view(), points_m);
    EXPECT_TRUE(points_m.empty());
}

}  // namespace
}  // namespace surefoot::camera
