// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/view_selection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot::calibration {
namespace {

/// Views on a line: the difference of two views is their distance.
std::vector<std::size_t> select(const std::vector<double>& places,
                                const SelectionLimits& limits,
                                std::vector<RejectedView>& rejected) {
    std::vector<std::size_t> all(places.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const auto motion = [&](std::size_t a, std::size_t b) {
        return std::abs(places[a] - places[b]);
    };
    return select_views(all, motion, limits, rejected);
}

TEST(ViewSelection, LeavesOutRepeats) {
    std::vector<RejectedView> rejected;
    const auto kept = select({0.0, 0.1, 5.0, 5.1, 0.3}, {.least_motion_px = 0.2}, rejected);
    EXPECT_EQ(kept, (std::vector<std::size_t>{0, 2, 4}));
    ASSERT_EQ(rejected.size(), 2U);
    EXPECT_EQ(rejected[1].index, 3U);
    EXPECT_NE(rejected[1].reason.find("the same as view 2"), std::string::npos);
}

TEST(ViewSelection, KeepsTheViewsThatDifferMost) {
    std::vector<RejectedView> rejected;
    const auto kept = select({0.0, 1.0, 2.0, 8.0, 9.0, 4.0}, {0.2, 3}, rejected);
    EXPECT_EQ(kept, (std::vector<std::size_t>{0, 4, 5}));
    EXPECT_EQ(rejected.size(), 3U);
}

TEST(ViewSelection, MotionIsKnownOfSharedPointsOnly) {
    const BoardView a{{1, 2, 5}, {{0, 0}, {10, 0}, {0, 10}}};
    const BoardView moved{{2, 5, 7}, {{13, 4}, {3, 14}, {0, 0}}};
    EXPECT_DOUBLE_EQ(motion_px(a, moved), 5.0);
    EXPECT_EQ(motion_px(a, {{7, 8}, {{0, 0}, {1, 1}}}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(motion_px({}, {}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace surefoot::calibration
