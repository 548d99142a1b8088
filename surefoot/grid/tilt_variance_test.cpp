// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/tilt_variance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::grid {
namespace {

TEST(TiltVariance, GrowsWithTheDistanceFromTheOriginOfOdom) {
    const GridGeometry geometry{0.5, 4, 2, {-1.0, -0.5}};  // centres at -0.75 ... 0.75, +-0.25
    Layer variance(4, 2, 1e-6F);
    variance.at(0, 1) = std::nanf("");
    const Layer sum = with_tilt_variance(variance.view(), geometry, 0.01);
    EXPECT_NEAR(sum.at(3, 0), 1e-6 + 1e-4 * (0.75 * 0.75 + 0.25 * 0.25), 1e-9);
    EXPECT_NEAR(sum.at(1, 0), 1e-6 + 1e-4 * 2.0 * 0.25 * 0.25, 1e-9);
    EXPECT_TRUE(std::isnan(sum.at(0, 1))) << "unknown stays unknown";
    EXPECT_EQ(with_tilt_variance(variance.view(), geometry, 0.0).at(2, 1), 1e-6F);
    EXPECT_TRUE(std::isinf(with_tilt_variance(variance.view(), geometry, NAN).at(2, 1)));
}

}  // namespace
}  // namespace surefoot::grid
