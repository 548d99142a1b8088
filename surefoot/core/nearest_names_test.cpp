// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/nearest_names.hpp"

#include <gtest/gtest.h>

namespace surefoot {
namespace {

TEST(NearestNames, FindTypingErrors) {
    const std::vector<std::string> names{"baseline_m", "focal_px", "rate_hz", "left"};
    EXPECT_EQ(nearest_names("basline_m", names).at(0), "baseline_m");
    EXPECT_EQ(nearest_names("foacl_px", names).at(0), "focal_px");
    EXPECT_TRUE(nearest_names("zzzzzzzz", names).empty());
    EXPECT_TRUE(nearest_names("", names).empty());
}

TEST(NearestNames, AreAskedForInOneWay) {
    const std::vector<std::string> names{"floor", "demo_stairs", "demo_stairs_up", "table"};
    EXPECT_EQ(did_you_mean("flor", names), "; did you mean 'floor'?");
    EXPECT_EQ(did_you_mean("nothing_like_it", names), "");
}

}  // namespace
}  // namespace surefoot
