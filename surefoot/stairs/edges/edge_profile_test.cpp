// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

// Rows that such a line does not cross meet it 1e9 cells away. As a 32-bit integer this distance
// would be negative, and the walk along the row would begin there.
TEST(EdgeProfiler, a_line_almost_along_the_rows_is_one_along_the_rows) {
    const testing::TestMap map(
        [](double, double y_m) { return y_m > 0.0 ? 0.2 : 0.0; }, 0.0, Vector2d::Zero());
    const Terrain terrain = map.terrain();
    EdgeProfiler profiler{StairsConfig{}};
    const auto along = profiler.measure(terrain, {{-1.0, 0.0}, {1.0, 0.0}});
    ASSERT_TRUE(along);
    for (const double turn_rad : {1e-8, 3e-9, -1e-8, -3e-9}) {
        const double tilt_m = std::sin(turn_rad);
        const auto almost = profiler.measure(terrain, {{-1.0, -tilt_m}, {1.0, tilt_m}});
        ASSERT_TRUE(almost) << turn_rad;
        EXPECT_DOUBLE_EQ(almost->upper_m, along->upper_m) << turn_rad;
        EXPECT_DOUBLE_EQ(almost->lower_m, along->lower_m) << turn_rad;
        EXPECT_NEAR((almost->middle_m() - along->middle_m()).norm(), 0.0, 1e-6) << turn_rad;
    }
}

}  // namespace
}  // namespace surefoot::stairs
