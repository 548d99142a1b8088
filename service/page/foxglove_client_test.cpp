// SPDX-License-Identifier: Apache-2.0
#include "service/page/foxglove_client.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "service/page/foxglove_testing.hpp"

namespace surefoot::page {
namespace {

using testing::Json;
using testing::number_at;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kTick_ns = 20 * kMs;

/// A service with one client and its own simulated time.
struct Service {
    PageFeed feed;
    Show show;
    FoxgloveShow foxglove{show};
    FoxgloveClient client{"surefoot", "a1"};
    std::int64_t now_ns = 1'000'000 * kMs;
    std::uint64_t frames = 0;

    /// A frame with a map of `side` cells, all of them known, and perhaps an image.
    void see(int side, bool with_image = false) {
        PageFrame& frame = feed.blank();
        frame.serial = ++frames;
        frame.pose.time_ns = static_cast<std::int64_t>(frames) * kMs;
        frame.pose.T_odom_body.translation_m.x() = static_cast<double>(frames);
        frame.has_map = true;
        frame.map_time_ns = frame.pose.time_ns;
        frame.map.resolution_tenth_mm = 250;
        frame.map.nx = frame.map.ny = side;
        std::fill_n(frame.map.height_tenth_mm.begin(), side * side, 5);
        std::fill_n(frame.map.source.begin(), side * side, grid::EvidenceSource::measured);
        frame.images_time_ns = with_image ? frame.pose.time_ns : 0;
        if (with_image) frame.left = GreyImage(64, 48, 128);
        feed.hand_over();
    }
    std::vector<SocketMessage> turn() {
        now_ns += kTick_ns;
        show.update(feed, now_ns);
        foxglove.update(now_ns, std::nullopt);
        return client.next(foxglove, now_ns);
    }
    Status ask(std::string_view text) { return client.take(true, text, now_ns); }
    void subscribe(std::uint32_t id, FoxgloveChannel channel) {
        const Json text{{"op", "subscribe"},
                        {"subscriptions", {{{"id", id}, {"channelId", id_of(channel)}}}}};
        ASSERT_TRUE(ask(text.dump()));
    }
};

/// The number of messages of each subscription.
std::map<std::uint32_t, int> counts_of(const std::vector<SocketMessage>& messages) {
    std::map<std::uint32_t, int> counts;
    for (const SocketMessage& message : messages) {
        if (!message.is_text && message.bytes[0] == 1)
            ++counts[number_at<std::uint32_t>(message.bytes, 1)];
    }
    return counts;
}

std::vector<Json> texts_of(const std::vector<SocketMessage>& messages) {
    std::vector<Json> texts;
    for (const SocketMessage& message : messages) {
        if (message.is_text) texts.push_back(Json::parse(message.bytes));
    }
    return texts;
}

/// The payload of the one message of a subscription.
Json payload_of(const std::vector<SocketMessage>& messages, std::uint32_t id) {
    for (const SocketMessage& message : messages) {
        if (!message.is_text && message.bytes[0] == 1 &&
            number_at<std::uint32_t>(message.bytes, 1) == id)
            return Json::parse(message.bytes.substr(13));
    }
    return {};
}

TEST(FoxgloveClient, IsToldFirstWhatThereIs) {
    Service service;
    const auto texts = texts_of(service.turn());
    ASSERT_EQ(texts.size(), 2U);
    EXPECT_EQ(texts[0].at("op"), "serverInfo");
    EXPECT_EQ(texts[1].at("op"), "advertise");
    EXPECT_TRUE(service.turn().empty());
}

TEST(FoxgloveClient, GetsTheTimeOfEachFrameAndNothingThatItDidNotAskFor) {
    Service service;
    service.turn();
    service.see(4, true);
    service.foxglove.hear({GateTopic::verdict, "{}"});
    const auto messages = service.turn();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].bytes, foxglove_time(kMs));
    EXPECT_TRUE(service.turn().empty());
    EXPECT_FALSE(service.client.listens_to(FoxgloveChannel::camera));
    EXPECT_EQ(service.client.gate_topics(), GateTopics{});
}

TEST(FoxgloveClient, GetsTheNewestOfWhatItAskedForOnce) {
    Service service;
    service.turn();
    service.see(4);
    service.see(4);
    service.subscribe(5, FoxgloveChannel::pose);
    const auto first = service.turn();
    EXPECT_EQ(counts_of(first), (std::map<std::uint32_t, int>{{5, 1}}));
    EXPECT_EQ(payload_of(first, 5)["pose"]["position"]["x"], 2.0);
    EXPECT_TRUE(service.turn().empty());
    service.see(4);
    EXPECT_EQ(payload_of(service.turn(), 5)["timestamp"]["nsec"], 3 * kMs);
    ASSERT_TRUE(service.ask(R"({"op":"unsubscribe","subscriptionIds":[5]})"));
    service.see(4);
    EXPECT_TRUE(counts_of(service.turn()).empty());
    service.subscribe(6, FoxgloveChannel::pose);
    EXPECT_EQ(payload_of(service.turn(), 6)["pose"]["position"]["x"], 4.0) << "at once";
}

TEST(FoxgloveClient, NoImageIsNoMessage) {
    Service service;
    service.turn();
    service.subscribe(1, FoxgloveChannel::camera);
    EXPECT_TRUE(service.client.listens_to(FoxgloveChannel::camera));
    service.see(4);
    EXPECT_TRUE(counts_of(service.turn()).empty());
    service.see(4, true);
    // before the client subscribed: the image of a frame that is no longer the newest
    service.see(4);
    EXPECT_TRUE(counts_of(service.turn()).empty()) << "it went with its frame";
    service.see(4, true);
    const Json image = payload_of(service.turn(), 1);
    EXPECT_EQ(image["timestamp"]["nsec"], 4 * kMs);
    EXPECT_EQ(testing::from_base64(image.at("data").get<std::string>()).substr(0, 2), "\xff\xd8");
}

TEST(FoxgloveClient, VerdictsComeOneByOneFromTheSubscriptionOn) {
    Service service;
    service.turn();
    service.foxglove.hear({GateTopic::verdict, R"({"sequence":1})"});
    service.subscribe(1, FoxgloveChannel::verdict);
    service.subscribe(2, FoxgloveChannel::outlook);
    EXPECT_EQ(service.client.gate_topics(), (GateTopics{true, true}));
    EXPECT_TRUE(counts_of(service.turn()).empty());
    service.foxglove.hear({GateTopic::verdict, R"({"sequence":2})"});
    service.foxglove.hear({GateTopic::verdict, R"({"sequence":3})"});
    service.foxglove.hear({GateTopic::outlook, R"({"state":"WARMUP"})"});
    service.foxglove.hear({GateTopic::outlook, R"({"state":"READY"})"});
    const auto messages = service.turn();
    EXPECT_EQ(counts_of(messages), (std::map<std::uint32_t, int>{{1, 2}, {2, 1}}));
    EXPECT_EQ(payload_of(messages, 1)["sequence"], 2);
    EXPECT_EQ(payload_of(messages, 2)["state"], "READY");
    for (std::size_t i = 0; i < 3 * FoxgloveShow::kRememberedVerdicts; ++i)
        service.foxglove.hear({GateTopic::verdict, "{}"});
    EXPECT_EQ(counts_of(service.turn())[1], static_cast<int>(FoxgloveShow::kRememberedVerdicts));
}

TEST(FoxgloveClient, WhatCannotBeMetIsSaid) {
    Service service;
    service.turn();
    service.subscribe(1, FoxgloveChannel::pose);
    const std::string first_beyond = std::to_string(kFoxgloveChannelCount + 1);
    for (const std::string& text :
         {std::string(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":0}]})"),
          R"({"op":"subscribe","subscriptions":[{"id":3,"channelId":)" + first_beyond + "}]}",
          std::string(R"({"op":"subscribe","subscriptions":[{"id":3,"channelId":99}]})"),
          std::string(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})"),
          std::string(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":5}]})"),
          std::string(R"({"op":"unsubscribe","subscriptionIds":[8,9]})"),
          std::string(R"({"op":"advertise","channels":[]})"),
          std::string(R"({"op":"setParameters","parameters":[]})")}) {
        ASSERT_TRUE(service.ask(text));
        const auto texts = texts_of(service.turn());
        ASSERT_EQ(texts.size(), 1U) << text;
        EXPECT_EQ(texts[0].at("op"), "status");
        EXPECT_EQ(texts[0].at("level"), 1) << text;
    }
    ASSERT_TRUE(service.client.take(false, "\x01", service.now_ns));
    EXPECT_EQ(texts_of(service.turn()).at(0).at("level"), 1);
    service.see(4);
    EXPECT_EQ(counts_of(service.turn()), (std::map<std::uint32_t, int>{{1, 1}})) << "all stands";
}

TEST(FoxgloveClient, GarbageIsSaidAndAFloodOfItEnds) {
    Service service;
    service.turn();
    int read = 0;
    while (service.ask("{") && read < 100) {
        EXPECT_EQ(texts_of(service.turn()).at(0).at("level"), 2);
        ++read;
    }
    EXPECT_EQ(read, 8);
    Service patient;
    for (int i = 0; i < 100; ++i) {
        patient.now_ns += 1000 * kMs;
        EXPECT_TRUE(patient.ask("{")) << "one a second is borne";
        patient.turn();
    }
}

TEST(FoxgloveClient, WhoAsksAndDoesNotReadIsLetGo) {
    Service service;
    int asked = 0;
    while (service.ask(R"({"op":"getParameters"})") && asked < 1000) ++asked;
    EXPECT_LT(asked, 100);
}

TEST(FoxgloveClient, LargeMessagesShareTwoMegabytesASecond) {
    Service service;
    service.turn();
    service.subscribe(1, FoxgloveChannel::ground);
    service.subscribe(2, FoxgloveChannel::ground_points);
    service.subscribe(3, FoxgloveChannel::camera);
    service.subscribe(4, FoxgloveChannel::transforms);
    std::map<std::uint32_t, int> counts;
    std::int64_t bytes = 0;
    constexpr int kSeconds = 10;
    for (std::int64_t t_ns = 0; t_ns < kSeconds * 1000 * kMs; t_ns += kTick_ns) {
        service.see(240, true);
        const auto messages = service.turn();
        for (const auto& [id, count] : counts_of(messages)) counts[id] += count;
        for (const SocketMessage& message : messages) bytes += std::ssize(message.bytes);
    }
    EXPECT_LE(bytes, (kSeconds + 1) * FoxgloveClient::kMostBytesPerSecond);
    EXPECT_GE(bytes, kSeconds * FoxgloveClient::kMostBytesPerSecond / 2);
    EXPECT_GE(counts[1], kSeconds / 2);
    EXPECT_GE(counts[2], kSeconds / 2);
    EXPECT_GE(counts[3], kSeconds / 2);
    EXPECT_EQ(counts[4], kSeconds * 50) << "small ones never wait";
}

TEST(FoxgloveClient, TheGroundComesTwiceASecondAtMostAndOnlyWhenItChanged) {
    Service service;
    service.turn();
    service.subscribe(1, FoxgloveChannel::ground);
    service.subscribe(2, FoxgloveChannel::ground_points);
    std::map<std::uint32_t, int> counts;
    constexpr int kSeconds = 10;
    const auto run = [&](bool sees) {
        counts.clear();
        for (std::int64_t t_ns = 0; t_ns < kSeconds * 1000 * kMs; t_ns += kTick_ns) {
            if (sees) service.see(10);
            for (const auto& [id, count] : counts_of(service.turn())) counts[id] += count;
        }
    };
    run(true);
    EXPECT_NEAR(counts[1], 2 * kSeconds, 1);
    EXPECT_NEAR(counts[2], kSeconds, 1);
    run(false);
    EXPECT_LE(counts[1], 1) << "the last one";
    run(false);
    EXPECT_EQ(counts[1], 0);
}

}  // namespace
}  // namespace surefoot::page
