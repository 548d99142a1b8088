// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/swept_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

/// Largest depth of the point inside the box during the motion, from fine steps along the path.
/// Negative outside.
double deepest_m(const Rect& box,
                 const PlanarPose& T_a_start,
                 const Vector2d& move_m,
                 double turn_rad,
                 const Vector2d& p_a) {
    constexpr int kSteps = 2000;
    double deepest = -1e9;
    for (int k = 0; k <= kSteps; ++k) {
        const double s = static_cast<double>(k) / kSteps;
        const PlanarPose T =
            T_a_start * PlanarPose::of(s * move_m.x(), s * move_m.y(), s * turn_rad);
        const Vector2d p = T.inverse_times(p_a);
        deepest =
            std::max(deepest, std::min((p - box.min_m).minCoeff(), (box.max_m - p).minCoeff()));
    }
    return deepest;
}

TEST(SweptBoxTest, CoversWhatAFineMarchCovers) {
    const Rect box{{-0.38, -0.37}, {0.38, 0.37}};
    Rng rng(5);
    for (const double turn_rad : {0.0, 0.26, -0.26, 0.05}) {
        for (const Vector2d& move_m : {Vector2d(0.4, 0.0), Vector2d(-0.1, 0.3), Vector2d(0, 0)}) {
            const PlanarPose T = PlanarPose::of(0.3, -0.2, 1.1);
            const SweptBox way(box, T, PlanarPose::of(move_m.x(), move_m.y(), turn_rad));
            // Half a degree at the corner's 0.53 m, halved; a straight way only by the march.
            const double tolerance_m = turn_rad == 0.0 ? 2e-4 : 2.6e-3;
            int inside = 0;
            for (int k = 0; k < 200; ++k) {
                const Vector2d p(rng.uniform(-0.8, 1.3), rng.uniform(-1.2, 0.8));
                const double depth_m = deepest_m(box, T, move_m, turn_rad, p);
                if (std::abs(depth_m) < tolerance_m) continue;
                EXPECT_EQ(way.covers(p), depth_m > 0.0) << p.transpose() << " turn " << turn_rad;
                inside += depth_m > 0.0 ? 1 : 0;
            }
            EXPECT_GT(inside, 20);
            EXPECT_LT(inside, 180);
        }
    }
}

TEST(SweptBoxTest, RimsBelongToItAndBoundsEncloseIt) {
    const SweptBox way({{-0.1, -0.2}, {0.1, 0.2}}, {}, PlanarPose::of(0.4, 0.0, 0.0));
    EXPECT_TRUE(way.covers({0.5, 0.2}));
    EXPECT_TRUE(way.covers({-0.1, -0.2}));
    EXPECT_FALSE(way.covers({0.5 + 1e-6, 0.0}));
    EXPECT_FALSE(way.covers({0.2, 0.2 + 1e-6}));
    EXPECT_NEAR(way.bounds().max_m.x(), 0.5, 1e-8);
    EXPECT_NEAR(way.bounds().min_m.x(), -0.1, 1e-8);
    EXPECT_NEAR(way.bounds().max_m.y(), 0.2, 1e-8);
}

}  // namespace
}  // namespace surefoot::sim
