// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/subscriptions.hpp"

#include <gtest/gtest.h>

namespace surefoot::gate_process {
namespace {

TopicMessage message(const char* body) {
    return {Topic::health, std::make_shared<const std::string>(body)};
}
std::string sent(const char* body) {
    return std::string(R"({"op":"publish","topic":"h","msg":)") + body + "}";
}
using Texts = std::vector<std::string>;

TEST(Subscriptions, NothingForOtherTopics) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(subscriptions.add(Topic::verdict, "v", {}));
    EXPECT_TRUE(subscriptions.offer(message("1"), 0).empty());
}

TEST(Subscriptions, EveryMessageWithoutAnInterval) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {}));
    EXPECT_EQ(subscriptions.offer(message("1"), 0), Texts{sent("1")});
    EXPECT_EQ(subscriptions.offer(message("2"), 0), Texts{sent("2")});
}

TEST(Subscriptions, TheNewestMessageIsKept) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "", .interval_ns = 10}));
    EXPECT_EQ(subscriptions.offer(message("1"), 100), Texts{sent("1")});
    EXPECT_TRUE(subscriptions.offer(message("2"), 101).empty());
    EXPECT_TRUE(subscriptions.offer(message("3"), 109).empty());
    EXPECT_TRUE(subscriptions.due(109).empty());
    EXPECT_EQ(subscriptions.due(110), Texts{sent("3")});
    EXPECT_TRUE(subscriptions.due(200).empty());
}

TEST(Subscriptions, AQueueKeepsOrder) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(
        subscriptions.add(Topic::health, "h", {.id = "", .interval_ns = 10, .queue_length = 2}));
    (void)subscriptions.offer(message("1"), 100);
    for (const char* body : {"2", "3", "4"}) (void)subscriptions.offer(message(body), 101);
    EXPECT_EQ(subscriptions.due(110), Texts{sent("3")});
    EXPECT_TRUE(subscriptions.due(119).empty());
    EXPECT_EQ(subscriptions.due(120), Texts{sent("4")});
}

TEST(Subscriptions, SeveralWishesAreOneStreamAtTheShortestInterval) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "slow", .interval_ns = 100}));
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "fast", .interval_ns = 10}));
    EXPECT_EQ(subscriptions.offer(message("1"), 0).size(), 1U);
    EXPECT_EQ(subscriptions.offer(message("2"), 10).size(), 1U);
    EXPECT_TRUE(subscriptions.remove(Topic::health, "fast"));
    EXPECT_EQ(subscriptions.offer(message("3"), 20).size(), 0U);
    EXPECT_FALSE(subscriptions.remove(Topic::health, "fast"));
    EXPECT_TRUE(subscriptions.remove(Topic::health, "slow"));
    EXPECT_TRUE(subscriptions.due(1000).empty());
    EXPECT_EQ(subscriptions.count(), 0U);
}

TEST(Subscriptions, WithoutAnIdAllOfATopicEnd) {
    Subscriptions subscriptions(8);
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "a"}));
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "b"}));
    ASSERT_TRUE(subscriptions.add(Topic::verdict, "v", {.id = "c"}));
    EXPECT_TRUE(subscriptions.remove(Topic::health, ""));
    EXPECT_EQ(subscriptions.count(), 1U);
}

TEST(Subscriptions, AWishOfTheSameIdReplacesTheOneBefore) {
    Subscriptions subscriptions(1);
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "a", .interval_ns = 100}));
    ASSERT_TRUE(subscriptions.add(Topic::health, "h", {.id = "a", .interval_ns = 1}));
    EXPECT_FALSE(subscriptions.add(Topic::health, "h", {.id = "b"}));
    EXPECT_FALSE(subscriptions.add(Topic::verdict, "v", {.id = "b"}));
    EXPECT_EQ(subscriptions.offer(message("1"), 0).size(), 1U);
    EXPECT_EQ(subscriptions.offer(message("2"), 1).size(), 1U);
}

}  // namespace
}  // namespace surefoot::gate_process
