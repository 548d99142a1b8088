// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/nearest_pixel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot {
namespace {

TEST(NearestPixel, RoundsAsLroundWithinTheImageAndIsNothingOutsideOfIt) {
    constexpr int kWidth = 7;
    constexpr int kHeight = 5;
    for (const int margin : {-3, 0, 1, 2}) {
        for (double v = -6.0; v <= 12.0; v += 0.125) {
            for (double u = -6.0; u <= 12.0; u += 0.125) {
                const long iu = std::lround(u);
                const long iv = std::lround(v);
                const bool inside =
                    iu >= margin && iv >= margin && iu + margin < kWidth && iv + margin < kHeight;
                const auto pixel = nearest_pixel(u, v, kWidth, kHeight, margin);
                ASSERT_EQ(pixel.has_value(), inside) << u << ' ' << v << ' ' << margin;
                if (!inside) continue;
                ASSERT_EQ(pixel->u, iu) << u;
                ASSERT_EQ(pixel->v, iv) << v;
            }
        }
    }
}

TEST(NearestPixel, PlacesBeyondAllIntegersAreOutside) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    // A conversion that drops the upper bits turns 2^32 + 3 into pixel 3.
    for (const double far :
         {std::nan(""), kInfinity, -kInfinity, 1e300, -1e300, 4294967299.0, -4294967293.0}) {
        EXPECT_FALSE(nearest_pixel(far, 2.0, 7, 5)) << far;
        EXPECT_FALSE(nearest_pixel(2.0, far, 7, 5)) << far;
    }
}

}  // namespace
}  // namespace surefoot
