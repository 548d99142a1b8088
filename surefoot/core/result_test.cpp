// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/result.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot {
namespace {

Result<int> parse(bool good) {
    if (!good) return input_error("a.txt:3: '7x' is no number");
    return 7;
}

TEST(Result, holds_the_value_or_the_reason) {
    EXPECT_TRUE(parse(true).ok());
    EXPECT_EQ(*parse(true), 7);
    const auto bad = parse(false);
    ASSERT_FALSE(bad.ok());
    EXPECT_EQ(bad.error().code, ErrorCode::input);
    EXPECT_EQ(bad.error().message, "a.txt:3: '7x' is no number");
}

TEST(Result, carries_move_only_values) {
    Result<std::unique_ptr<int>> result(std::make_unique<int>(3));
    const std::unique_ptr<int> moved = std::move(result).value();
    EXPECT_EQ(*moved, 3);
}

TEST(Result, asking_a_failure_for_its_value_is_our_bug) {
    EXPECT_DEATH((void)parse(false).value(), "broken invariant");
}

TEST(Status, is_good_by_default) {
    EXPECT_TRUE(Status().ok());
    EXPECT_FALSE(Status(usage_error("no")).ok());
}

TEST(Time, rounds_seconds_to_the_nearest_nanosecond) {
    EXPECT_EQ(ns_from_seconds(1.0000000004), 1'000'000'000);
    EXPECT_EQ(ns_from_seconds(-0.0000000016), -2);
    EXPECT_DOUBLE_EQ(seconds_from_ns(1'500'000'000), 1.5);
}

TEST(Image, is_row_major_and_checks_its_bounds) {
    Image<int> image(3, 2, 9);
    image.at(2, 1) = 5;
    EXPECT_EQ(image.data()[5], 5);
    EXPECT_EQ(image.view().at(2, 1), 5);
    EXPECT_FALSE(image.contains(3, 0));
    EXPECT_DEATH((void)image.at(0, 2), "broken invariant");
}

TEST(Serial, runs_every_index_once_in_order) {
    std::vector<int> order;
    Serial().parallel_for(4, [&](int index) { order.push_back(index); });
    EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3}));
    Serial().parallel_for(0, [&](int) { FAIL(); });
}

}  // namespace
}  // namespace surefoot
