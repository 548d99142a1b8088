// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/thesis_policy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

/// 1 m x 1 m of cells of 0.1 m, middles at 0.05, 0.15 ...
const grid::GridGeometry kGrid{0.1, 10, 10, {0.0, 0.0}};
/// Covers 2 cells along and 4 across when it stands on a corner of cells.
const ThesisPolicy kPolicy;

TEST(ThesisPolicy, TakesTheMeanUnderTheRectangle) {
    Image<float> rating(10, 10, 1.0F);
    rating.at(4, 3) = 0.0F;  // one of 8 cells: mean 7 / 8
    const ThesisAnswer answer = thesis_policy(kPolicy, {0.5, 0.5, 0.0}, kGrid, rating.view());
    EXPECT_EQ(answer.cells, 8);
    EXPECT_DOUBLE_EQ(answer.mean, 0.875);
    EXPECT_TRUE(answer.allowed);
    ThesisPolicy exact;
    exact.safe_mean = 0.875;
    EXPECT_TRUE(thesis_policy(exact, {0.5, 0.5, 0.0}, kGrid, rating.view()).allowed);
    rating.at(4, 4) = 0.0F;  // 6 / 8: a quarter of the ground is gone
    EXPECT_FALSE(thesis_policy(kPolicy, {0.5, 0.5, 0.0}, kGrid, rating.view()).allowed);
}

TEST(ThesisPolicy, LiesWithTheRobot) {
    Image<float> rating(10, 10, 1.0F);
    for (int iy = 0; iy < 10; ++iy) rating.at(3, iy) = 0.0F;  // x from 0.3 to 0.4
    EXPECT_DOUBLE_EQ(thesis_policy(kPolicy, {0.5, 0.5, 0.0}, kGrid, rating.view()).mean, 1.0);
    EXPECT_DOUBLE_EQ(
        thesis_policy(kPolicy, {0.5, 0.5, std::numbers::pi / 2.0}, kGrid, rating.view()).mean,
        0.75);
}

TEST(ThesisPolicy, AllowsGroundThatNobodyHasSeen) {
    const Image<float> rating(10, 10, kNanF);
    const ThesisAnswer inside = thesis_policy(kPolicy, {0.5, 0.5, 0.0}, kGrid, rating.view());
    EXPECT_TRUE(inside.allowed);
    EXPECT_EQ(inside.unmapped, 8);
    EXPECT_TRUE(thesis_policy(kPolicy, {-5.0, 0.5, 0.0}, kGrid, rating.view()).allowed);
}

TEST(ThesisPolicy, UnmappedGroundHidesWhatIsBad) {
    Image<float> rating(10, 10, kNanF);
    rating.at(4, 4) = 0.0F;
    EXPECT_TRUE(thesis_policy(kPolicy, {0.5, 0.5, 0.0}, kGrid, rating.view()).allowed);
    ThesisPolicy cautious;
    cautious.unmapped = 0.0;
    EXPECT_FALSE(thesis_policy(cautious, {0.5, 0.5, 0.0}, kGrid, rating.view()).allowed);
}

}  // namespace
}  // namespace surefoot::eval
