// SPDX-License-Identifier: Apache-2.0
#include "service/live/paced_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot::app {
namespace {

TEST(PacedTime, AnySpeedGivesATimeThatAClockCanAdd) {
    EXPECT_EQ(paced_ns(1'000'000'000, 1.0), 1'000'000'000);
    EXPECT_EQ(paced_ns(1'000'000'000, 4.0), 250'000'000);
    EXPECT_EQ(paced_ns(-1'000'000'000, 0.5), -2'000'000'000);
    EXPECT_EQ(paced_ns(1'000'000'000, std::numeric_limits<double>::infinity()), 0);
    // Without the limit, the conversion of a too large number gives the smallest integer: a frame
    // that was due long ago.
    for (const double slow : {1e-9, 1e-300, std::numeric_limits<double>::denorm_min()}) {
        EXPECT_GT(paced_ns(1'000'000'000'000, slow), std::int64_t{3'000'000'000} * 1'000'000'000);
        EXPECT_LT(paced_ns(-1'000'000'000'000, slow), 0);
        const std::int64_t half_way = std::numeric_limits<std::int64_t>::max() / 2;
        EXPECT_GT(half_way + paced_ns(1'000'000'000'000, slow), half_way);
    }
    EXPECT_EQ(paced_ns(0, 1e-300), 0);
    EXPECT_EQ(paced_ns(5, std::nan("")), 0);
}

}  // namespace
}  // namespace surefoot::app
