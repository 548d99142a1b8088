// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/catalogue.hpp"

#include <gtest/gtest.h>

#include "service/gate_process/sockets/token_bucket.hpp"

namespace surefoot::gate_process {
namespace {

TEST(Catalogue, NamesWithAndWithoutTheirSlash) {
    for (const auto& entry : kServices) {
        EXPECT_EQ(find_service(entry.name), &entry);
        EXPECT_EQ(find_service(entry.name.substr(1)), &entry);
    }
    for (const auto& entry : kTopics) EXPECT_EQ(find_topic(entry.name.substr(1)), &entry);
    for (const char* name : {"", "/", "//step", "/step/", "/ste", "/stepp", "STEP"})
        EXPECT_EQ(find_service(name), nullptr) << name;
}

TEST(Catalogue, TheFormerNameOfTheAttestationFindsIt) {
    const ServiceEntry* attest = find_service("/surefoot/attest");
    ASSERT_NE(attest, nullptr);
    EXPECT_EQ(attest->service, Service::attest);
    EXPECT_EQ(find_service("/surefoot/vouch"), attest);
    EXPECT_EQ(find_service("surefoot/vouch"), attest);
}

TEST(Catalogue, TypesInTheSpellingOfBothRosVersions) {
    EXPECT_TRUE(same_type("a_msgs/B", "a_msgs/B"));
    EXPECT_TRUE(same_type("a_msgs/B", "a_msgs/msg/B"));
    for (const char* other : {"",
                              "B",
                              "a_msgs/C",
                              "a_msgs/msg/C",
                              "b_msgs/msg/B",
                              "a_msgs/msgB",
                              "a_msgs/msg/msg/B",
                              "a_msgs/srv/B"})
        EXPECT_FALSE(same_type("a_msgs/B", other)) << other;
}

TEST(TokenBucket, BurstThenRate) {
    TokenBucket bucket({.per_s = 10, .burst = 2});
    constexpr std::int64_t kMs = 1'000'000;
    EXPECT_TRUE(bucket.take(0));
    EXPECT_TRUE(bucket.take(0));
    EXPECT_FALSE(bucket.take(0));
    EXPECT_FALSE(bucket.take(99 * kMs));
    EXPECT_TRUE(bucket.take(100 * kMs));
    EXPECT_FALSE(bucket.take(100 * kMs));
    EXPECT_TRUE(bucket.take(10'000 * kMs));
    EXPECT_TRUE(bucket.take(10'000 * kMs));
    EXPECT_FALSE(bucket.take(10'000 * kMs));
}

}  // namespace
}  // namespace surefoot::gate_process
