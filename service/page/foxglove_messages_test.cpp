// SPDX-License-Identifier: Apache-2.0
#include "service/page/foxglove_messages.hpp"

#include <gtest/gtest.h>

#include <set>

#include "service/gate_process/protocol/verdict_json.hpp"
#include "service/page/foxglove_schemas.hpp"
#include "service/page/foxglove_testing.hpp"

namespace surefoot::page {
namespace {

using namespace std::string_literals;
using testing::from_base64;
using testing::Json;
using testing::number_at;

PagePose pose() {
    PagePose pose;
    pose.time_ns = 2'000'000'007;
    pose.T_odom_body = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.25, -0.5, 0.75}};
    return pose;
}

PageStatus status() {
    PageStatus status;
    status.time_ns = 3'000'000'000;
    status.frames = 45;
    status.rate_hz = 15.0;
    status.state = SourceState::running;
    status.text = "sim:floor";
    status.health = Health::degraded;
    status.reasons = {"BLUR"};
    status.stages = {{"stereo", 10.5, 9.0}, {"fuse", 4.0, 3.5}};
    return status;
}

TEST(FoxgloveMessages, TheNewestSubprotocolThatBothSpeakIsChosen) {
    EXPECT_EQ(foxglove_protocol_of("foxglove.websocket.v1"), "foxglove.websocket.v1");
    EXPECT_EQ(foxglove_protocol_of("foxglove.sdk.v1"), "foxglove.sdk.v1");
    EXPECT_EQ(foxglove_protocol_of("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.sdk.v1");
    EXPECT_EQ(foxglove_protocol_of("x,foxglove.websocket.v1 ,y"), "foxglove.websocket.v1");
    for (const char* other : {"", " ", ",,", "foxglove.sdk.v10", "foxglove", "xfoxglove.sdk.v1"})
        EXPECT_EQ(foxglove_protocol_of(other), std::nullopt) << other;
}

TEST(FoxgloveMessages, BinaryMessagesAreThoseOfTheProtocol) {
    EXPECT_EQ(foxglove_message(0x01020304, 0x1122334455667788, "{}"),
              "\x01\x04\x03\x02\x01\x88\x77\x66\x55\x44\x33\x22\x11{}"s);
    EXPECT_EQ(foxglove_time(1), "\x02\x01\0\0\0\0\0\0\0"s);
    EXPECT_EQ(foxglove_time(-5), "\x02\0\0\0\0\0\0\0\0"s) << "a time before 1970";
}

TEST(FoxgloveMessages, TheServiceIntroducesItself) {
    EXPECT_EQ(Json::parse(foxglove_server_info("surefoot", "a1")),
              Json::parse(R"({"op": "serverInfo", "name": "surefoot", "capabilities": ["time"],
                  "supportedEncodings": ["json"], "metadata": {}, "sessionId": "a1"})"));
    EXPECT_EQ(Json::parse(foxglove_status(FoxgloveLevel::warning, "no")),
              Json::parse(R"({"op": "status", "level": 1, "message": "no"})"));
}

/// A client builds tables from a schema: it knows plain types only.
void expect_plain(const Json& schema, const std::string& where) {
    ASSERT_TRUE(schema.contains("type") && schema["type"].is_string()) << where;
    const auto type = schema["type"].get<std::string>();
    const std::set<std::string> known{"object", "array", "string", "number", "integer"};
    ASSERT_TRUE(known.contains(type)) << where << ": " << type;
    if (type == "array") {
        ASSERT_NE(schema.at("items").at("type"), "array") << where;
        expect_plain(schema.at("items"), where + "[]");
    }
    if (type != "object") return;
    for (const auto& [name, property] : schema.at("properties").items())
        expect_plain(property, where + "." + name);
}

TEST(FoxgloveMessages, ChannelsSayWhatTheyAre) {
    const Json advertise = Json::parse(foxglove_advertise());
    EXPECT_EQ(advertise.at("op"), "advertise");
    ASSERT_EQ(advertise.at("channels").size(), kFoxgloveChannelCount);
    std::set<std::string> topics;
    std::uint32_t id = 0;
    for (const Json& channel : advertise.at("channels")) {
        EXPECT_EQ(channel.at("id"), ++id);
        topics.insert(channel.at("topic").get<std::string>());
        EXPECT_EQ(channel.at("encoding"), "json");
        EXPECT_EQ(channel.at("schemaEncoding"), "jsonschema");
        const Json schema = Json::parse(channel.at("schema").get<std::string>());
        EXPECT_EQ(schema.at("title"), channel.at("schemaName"));
        expect_plain(schema, channel.at("schemaName").get<std::string>());
    }
    EXPECT_EQ(topics.size(), kFoxgloveChannelCount);
    EXPECT_EQ(advertise["channels"][0]["schemaName"], "foxglove.Grid");
    EXPECT_EQ(advertise["channels"][0]["topic"], "/surefoot/ground");
}

TEST(FoxgloveMessages, TheGridIsThePartThatIsKnown) {
    const Json grid = Json::parse(ground_payload(testing::small_ground()));
    EXPECT_EQ(grid.at("timestamp"), Json({{"sec", 1'403'636'579}, {"nsec", 763'555'584}}));
    EXPECT_EQ(grid.at("frame_id"), "odom");
    // Cells 1 and 2 of rows 0 and 1.
    EXPECT_EQ(grid["pose"]["position"], Json({{"x", -0.9}, {"y", 2.0}, {"z", 0.0}}));
    EXPECT_EQ(grid.at("cell_size"), Json({{"x", 0.1}, {"y", 0.1}}));
    EXPECT_EQ(grid.at("column_count"), 2);
    EXPECT_EQ(grid.at("cell_stride"), 10);
    EXPECT_EQ(grid.at("row_stride"), 20);
    EXPECT_EQ(grid["fields"][0], Json({{"name", "height_m"}, {"offset", 0}, {"type", 7}}));
    EXPECT_EQ(grid["fields"][6], Json({{"name", "alpha"}, {"offset", 9}, {"type", 1}}));
    const std::string cells = from_base64(grid.at("data").get<std::string>());
    ASSERT_EQ(cells.size(), 40U);
    EXPECT_FLOAT_EQ(number_at<float>(cells, 0), 9.75F);
    EXPECT_EQ(cells.substr(4, 6), "\x03\x01\x00\x9e\x73\xff"s);
    EXPECT_TRUE(std::isnan(number_at<float>(cells, 10)));
    EXPECT_EQ(cells.substr(14, 6), "\xff\0\0\0\0\0"s) << "transparent";
    EXPECT_FLOAT_EQ(number_at<float>(cells, 30), 10.017F);
    EXPECT_EQ(cells.substr(34, 6), "\x0c\x0a\xd5\x5e\x00\xff"s);
}

TEST(FoxgloveMessages, AGridOfNothingIsOneCell) {
    PageMap map = testing::small_ground();
    map.cells.assign(12, PageCell{});
    const Json grid = Json::parse(ground_payload(map));
    EXPECT_EQ(grid.at("column_count"), 1);
    EXPECT_EQ(from_base64(grid.at("data").get<std::string>()).size(), 10U);
    EXPECT_EQ(Json::parse(ground_points_payload(map)).at("data"), "");
}

TEST(FoxgloveMessages, PointsAreTheMiddlesOfKnownCells) {
    const Json cloud = Json::parse(ground_points_payload(testing::small_ground()));
    EXPECT_EQ(cloud["pose"]["position"], Json({{"x", -1.0}, {"y", 2.0}, {"z", 0.0}}));
    EXPECT_EQ(cloud.at("point_stride"), 16);
    EXPECT_EQ(cloud["fields"][2], Json({{"name", "z"}, {"offset", 8}, {"type", 7}}));
    const std::string points = from_base64(cloud.at("data").get<std::string>());
    ASSERT_EQ(points.size(), 32U);
    EXPECT_FLOAT_EQ(number_at<float>(points, 0), 0.15F);
    EXPECT_FLOAT_EQ(number_at<float>(points, 4), 0.05F);
    EXPECT_FLOAT_EQ(number_at<float>(points, 8), 9.75F);
    EXPECT_FLOAT_EQ(number_at<float>(points, 16), 0.25F);
    EXPECT_FLOAT_EQ(number_at<float>(points, 20), 0.15F);
    EXPECT_EQ(points.substr(28, 4), "\xd5\x5e\x00\xff"s);
}

TEST(FoxgloveMessages, ImagesAreBase64) {
    const auto data = [](std::string_view bytes) {
        return Json::parse(camera_payload(1'500'000'000, bytes)).at("data");
    };
    EXPECT_EQ(data("\xff\xd8\xff"), "/9j/");
    EXPECT_EQ(data("\xff\xd8"), "/9g=");
    EXPECT_EQ(data("\xff"), "/w==");
    EXPECT_EQ(data("Surefoot"), "U3VyZWZvb3Q=");
    Json image = Json::parse(camera_payload(1'500'000'000, "x"));
    image.erase("data");
    EXPECT_EQ(image, Json::parse(R"({"timestamp": {"sec": 1, "nsec": 500000000},
        "frame_id": "camera", "format": "jpeg"})"));
}

TEST(FoxgloveMessages, TransformsGoFromOdomToTheCamera) {
    const Json there = Json::parse(R"({"transforms": [
        {"timestamp": {"sec": 2, "nsec": 7}, "parent_frame_id": "odom",
         "child_frame_id": "base_link", "translation": {"x": 1.25, "y": -0.5, "z": 0.75},
         "rotation": {"x": 0.5, "y": -0.5, "z": 0.5, "w": 0.5}},
        {"timestamp": {"sec": 2, "nsec": 7}, "parent_frame_id": "base_link",
         "child_frame_id": "camera", "translation": {"x": 0.5, "y": 0.0, "z": 0.25},
         "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}]})");
    const Pose T_body_camera{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.25}};
    EXPECT_EQ(Json::parse(transforms_payload(pose(), T_body_camera)), there);
    EXPECT_EQ(Json::parse(transforms_payload(pose(), std::nullopt)).at("transforms").size(), 1U);
    const Json at = Json::parse(pose_payload(pose()));
    EXPECT_EQ(at.at("frame_id"), "odom");
    EXPECT_EQ(at.at("timestamp"), there["transforms"][0]["timestamp"]);
    EXPECT_EQ(at["pose"]["position"], there["transforms"][0]["translation"]);
    EXPECT_EQ(at["pose"]["orientation"], there["transforms"][0]["rotation"]);
}

TEST(FoxgloveMessages, StatusCanBePlotted) {
    EXPECT_EQ(Json::parse(status_payload(status(), CameraState::ok)),
              Json::parse(R"({"timestamp": {"sec": 3, "nsec": 0}, "state": "running",
                  "text": "sim:floor", "health": "DEGRADED", "camera": ")" +
                          std::string(to_string(CameraState::ok)) + R"(",
                  "reasons": ["BLUR"], "frames": 45, "rate_hz": 15.0, "total_ms": 14.5,
                  "stage_ms": {"stereo": 10.5, "fuse": 4.0},
                  "median_ms": {"stereo": 9.0, "fuse": 3.5}})"));
}

TEST(FoxgloveMessages, PayloadsKeepToTheirSchemas) {
    const auto check = [](FoxgloveChannel channel, const std::string& payload) {
        EXPECT_EQ(testing::problem_of(
                      Json::parse(payload), Json::parse(schema_of(channel)), topic_of(channel)),
                  "");
    };
    check(FoxgloveChannel::ground, ground_payload(testing::small_ground()));
    check(FoxgloveChannel::ground_points, ground_points_payload(testing::small_ground()));
    check(FoxgloveChannel::camera, camera_payload(-1, "x"));
    check(FoxgloveChannel::transforms, transforms_payload(pose(), Pose{}));
    check(FoxgloveChannel::pose, pose_payload(pose()));
    check(FoxgloveChannel::status, status_payload(status(), CameraState::ok));
    check(FoxgloveChannel::verdict, gate_process::dump(gate_process::verdict_object({}, "no way")));
}

template <typename T>
T read(std::string_view text) {
    const auto request = parse_foxglove_request(text);
    EXPECT_TRUE(request) << request.error().message;
    return std::get<T>(*request);
}

TEST(FoxgloveMessages, RequestsAreRead) {
    const auto subscribe = read<FoxgloveSubscribe>(
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":1}]})");
    ASSERT_EQ(subscribe.wishes.size(), 2U);
    EXPECT_EQ(subscribe.wishes[0].channel, 3U);
    EXPECT_EQ(subscribe.wishes[1].subscription, 4294967295U);
    EXPECT_EQ(
        read<FoxgloveUnsubscribe>(R"({"op":"unsubscribe","subscriptionIds":[7]})").subscriptions,
        std::vector<std::uint32_t>{7});
    EXPECT_EQ(read<FoxgloveUnserved>(R"({"op":"getParameters","parameterNames":[]})").operation,
              "getParameters");
    EXPECT_EQ(
        read<FoxgloveUnserved>(R"({"op":")" + std::string(5000, 'x') + "\"}").operation.size(),
        40U);
}

TEST(FoxgloveMessages, WhatCannotBeReadIsAnError) {
    for (const char* text :
         {"",
          "{",
          "[]",
          "\xff",
          R"({"op":5})",
          R"({"op":"subscribe"})",
          R"({"op":"subscribe","subscriptions":{}})",
          R"({"op":"subscribe","subscriptions":[7]})",
          R"({"op":"subscribe","subscriptions":[{"id":0}]})",
          R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
          R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1.5}]})",
          R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
          R"({"op":"subscribe","subscriptions":[{"id":"0","channelId":1}]})",
          R"({"op":"unsubscribe","subscriptionIds":[null]})",
          R"({"op":"unsubscribe","subscriptionIds":7})",
          R"({"op":"x","op":"y"})",
          "[[[[[[[[[[]]]]]]]]]]"})
        EXPECT_FALSE(parse_foxglove_request(text)) << text;
    EXPECT_FALSE(parse_foxglove_request(std::string(kMaxFoxgloveText_bytes + 1, ' ')));
}

}  // namespace
}  // namespace surefoot::page
