// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/near_side.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "surefoot/ground/frames_testing.hpp"
#include "surefoot/ground/refine_plane.hpp"

namespace surefoot::ground {
namespace {

constexpr double kBand_m = 0.04;

/// The single plane that fits all points best.
geometry::Plane across(const FramePoints& frame, double height_m) {
    return refine_plane(frame.points_body_m,
                        frame.inverse_range_sigma,
                        {Eigen::Vector3d::UnitZ(), height_m},
                        0.2)
        .value_or(geometry::Plane{});
}

std::optional<NearSide> split(const FramePoints& frame, const geometry::Plane& plane) {
    return near_side(frame.points_body_m, frame.inverse_range_sigma, plane, kBand_m);
}

TEST(NearSide, APlaneIsOne) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const FramePoints frame = test::seen({{}}, {.seed = seed});
        EXPECT_FALSE(split(frame, across(frame, 1.0))) << seed;
    }
}

TEST(NearSide, ALowSillOrAMatIsNoReasonToSplit) {
    const FramePoints frame = test::seen({{.max_x_m = 1.2}, {.z_m = 0.01, .min_x_m = 1.2}});
    EXPECT_FALSE(split(frame, across(frame, 1.0)));
}

TEST(NearSide, AcrossAKerbItEndsAtTheKerb) {
    for (const double kerb_m : {0.075, -0.075, 0.1, -0.1}) {
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            const FramePoints frame =
                test::seen({{.max_x_m = 1.1}, {.z_m = kerb_m, .min_x_m = 1.1}}, {.seed = seed});
            const geometry::Plane both = across(frame, 1.0 - 0.5 * kerb_m);
            ASSERT_GT(both.normal.head<2>().norm(), 0.01) << "laid across";
            const auto side = split(frame, both);
            ASSERT_TRUE(side) << kerb_m;
            EXPECT_NEAR(std::abs(side->axis.x()), 1.0, 0.01);
            EXPECT_NEAR(side->to_m, 1.1, 0.12) << kerb_m;
            EXPECT_TRUE(side->contains({0.8, 0.0, -1.0}));
            EXPECT_FALSE(side->contains({1.4, 0.0, -1.0}));
        }
    }
}

TEST(NearSide, BesideAKerbItIsTheSideOfTheCamera) {
    for (const double sign : {1.0, -1.0}) {
        test::Surface road{.z_m = -0.1};
        (sign > 0.0 ? road.min_y_m : road.max_y_m) = 0.2 * sign;
        test::Surface pavement;
        (sign > 0.0 ? pavement.max_y_m : pavement.min_y_m) = 0.2 * sign;
        const FramePoints frame = test::seen({road, pavement});
        const auto side = split(frame, across(frame, 1.05));
        ASSERT_TRUE(side);
        EXPECT_TRUE(side->contains({1.0, 0.0, -1.0}));
        EXPECT_FALSE(side->contains({1.0, 0.6 * sign, -1.0}));
    }
}

TEST(NearSide, NothingIsSaidOfFewPoints) {
    FramePoints frame = test::seen({{.max_x_m = 1.1}, {.z_m = 0.1, .min_x_m = 1.1}});
    const geometry::Plane both = across(frame, 0.95);
    frame.points_body_m.resize(150);
    frame.inverse_range_sigma.resize(150);
    EXPECT_FALSE(split(frame, both));
    EXPECT_FALSE(split({}, both));
    EXPECT_FALSE(split(frame, {Eigen::Vector3d::UnitZ(), -1.0}));
}

}  // namespace
}  // namespace surefoot::ground
