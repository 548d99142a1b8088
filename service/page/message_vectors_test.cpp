// SPDX-License-Identifier: Apache-2.0
// message_vectors.json holds an example of every message; the page's tests read the same file.
// SUREFOOT_WRITE_VECTORS=1 page_test --gtest_filter='MessageVectors.*' writes the file again.
#include <gtest/gtest.h>

#include <cstdlib>

#include "service/page/feature_lists.hpp"
#include "service/page/page_decoder_testing.hpp"
#include "service/page/page_map.hpp"
#include "service/page/page_messages.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::page {
namespace {

using testing::Json;

const std::string kContract = std::string(SUREFOOT_SOURCE_DIR) + "/service/page/messages.json";
const std::string kVectors =
    std::string(SUREFOOT_SOURCE_DIR) + "/service/page/message_vectors.json";

PageMap small_map() {
    PageMap map;
    map.version = 7;
    // stamp of a recording: above 2^53, the limit of a page's integers
    map.frame_time_ns = 1'403'636'579'763'555'584;
    map.origin_x_tenth_mm = -500;
    map.origin_y_tenth_mm = 1250;
    map.base_z_tenth_mm = 0;
    map.resolution_tenth_mm = 250;
    map.nx = 6;
    map.ny = 3;
    map.edges.push_back({0, 250, 1500, 250, 12, -1738, 40, 60});
    map.cells.assign(18, PageCell{});
    map.cells[0] = {0, 3, 1};
    map.cells[1] = {-4, 255, 3};
    map.cells[5] = {-32767, 12, 2 | kDropBit};
    map.cells[6] = {32767, 1, 2 | kOverheadBit};  // the run continues in the next row
    map.cells[17] = {0, 0, 1 | kAttestedBit};
    map.cells[10].state = kAttestedBit;  // attested by an operator, never measured
    return map;
}

/// A whole map, changed cells, a window moved by (1, -1) cells, and a window that is not aligned
/// with it.
std::vector<PageMap> map_sequence() {
    PageMap first = small_map();
    PageMap changed = first;
    changed.version = 8;
    changed.edges.clear();
    changed.cells[1] = {-5, 9, 1};
    changed.cells[3] = {2, 9, 1};
    changed.cells[17] = PageCell{};
    PageMap moved = changed;
    moved.version = 9;
    moved.origin_x_tenth_mm += moved.resolution_tenth_mm;
    moved.origin_y_tenth_mm -= moved.resolution_tenth_mm;
    for (int iy = 0; iy < moved.ny; ++iy) {
        for (int ix = 0; ix < moved.nx; ++ix) {
            const bool inside = ix + 1 < moved.nx && iy - 1 >= 0;
            moved.cells[static_cast<std::size_t>(iy * moved.nx + ix)] =
                inside ? changed.cells[static_cast<std::size_t>((iy - 1) * moved.nx + ix + 1)]
                       : PageCell{};
        }
    }
    moved.cells[2] = {77, 4, 1};
    PageMap anew = moved;
    anew.version = 1;
    anew.origin_x_tenth_mm += 10;  // not a whole number of cells
    return {first, changed, moved, anew};
}

PagePose pose() {
    PagePose pose;
    pose.time_ns = 2'000'000'000;
    pose.T_odom_body.translation_m = {1.25, -0.5, 0.990};
    pose.T_odom_body.rotation = Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5);
    pose.variance_x_m2 = 0.0625;
    pose.variance_y_m2 = 0.25;
    pose.covariance_xy_m2 = -0.03125;
    pose.variance_yaw_rad2 = 0.0009765625;
    pose.health = Health::degraded;
    pose.camera = CameraState::ok;
    return pose;
}

PageLayer layer() {
    PageLayer layer{9, -500, 1250, 250, 2, Image<float>(3, 2, kNanF)};
    layer.values.at(0, 0) = 0.5F;
    layer.values.at(2, 1) = -1.25F;
    return layer;
}

PageHello hello() {
    PageHello hello{"surefoot 0.1.0",
                    "sim:walk_floor",
                    "simulated",
                    9090,
                    {"height_m", "sigma_m"},
                    std::nullopt,
                    {{0.1, 0.2}, {0.5, 0.2}, {0.5, -0.2}},
                    false,
                    15.0};
    PageHello::Machine machine;
    machine.name = "rex";
    machine.limits.sole_depth_tenth_mm = 9900;
    machine.limits.limits.attestation_radius_tenth_mm = 10000;
    machine.limits.left_foot = {570, 1800, 3660, 1900};
    machine.limits.right_foot = {570, -1800, 3660, 1900};
    machine.limits.movements[9] = {true, MovementClass::walk, {'N'}, 4000, 0, 1.0, 0.0};
    machine.limits.movements[25] = {
        true, MovementClass::walk, {'l', 'e', 'f', 't'}, 0, 0, 0.0, 1.0};
    machine.limits.body.parts[0] = {{-100, 0, 7200, 9400}, 6200, 13300};
    machine.limits.body.count = 1;
    machine.part_names = {"frame"};
    machine.joints = {{"knee", 0.0625}, {"ankle", -0.125}};
    machine.urdf = "<robot name=\"rex\"/>";
    hello.machine = machine;
    return hello;
}

PageStatus status() {
    return {2'000'000'000,
            30,
            14.5,
            SourceState::running,
            "frames come",
            Health::degraded,
            {"few_tracks"},
            {{"stereo", 10.5, 11.0}},
            2};
}

/// One feature of each kind; first a flight of three steps.
stairs::TerrainFeatures features() {
    stairs::TerrainFeatures features;
    features.time_ns = 2'000'000'000;
    const stairs::Tracked tracked{7, 4, 1'750'000'000, false};
    stairs::Flight flight;
    flight.pose = {{1.5, -0.25, 0.0}, 0.125};
    flight.steps = 3;
    flight.riser_m = 0.18;
    flight.riser_sigma_m = 0.002;
    flight.riser_spread_m = 0.004;
    flight.going_m = 0.31;
    flight.going_sigma_m = 0.005;
    flight.going_spread_m = 0.008;
    flight.width_m = 1.5;
    flight.landing_m = 0.75;
    flight.left = {stairs::SideKind::wall, 0.0};
    flight.right = {stairs::SideKind::open, 0.95};
    flight.tracked = tracked;
    features.flights.push_back(flight);
    stairs::Flight step = flight;  // a single step has no going
    step.kind = stairs::FlightKind::down;
    step.steps = 1;
    step.going_m = step.going_sigma_m = step.going_spread_m = kNanF;
    step.cut = true;
    step.tracked.id = 8;
    features.flights.push_back(step);
    stairs::LineFeature line;
    line.pose = {{2.0, 0.5, 0.0}, -0.5};
    line.height_m = -0.175;
    line.length_m = 1.25;
    line.sigma_m = 0.0625;
    line.bottom_seen = false;
    line.tracked = tracked;
    features.drops.push_back(line);
    line.bottom_seen = true;
    features.kerbs.push_back(line);
    line.height_m = 0.03125;
    features.sills.push_back(line);
    features.doors.push_back({line.pose, 0.875, 0.015625, 0.03125, 0.0078125, kNanF, tracked});
    stairs::Edge edge;
    edge.from_m = {1.5, -1.0};
    edge.to_m = {1.5, 0.5};
    edge.upper_m = 0.18;
    edge.lower_seen = true;
    edge.height_sigma_m = 0.003;
    edge.tracked = tracked;
    features.edges.push_back(edge);
    return features;
}

const std::vector<PageSetting> kSettings{
    {"elevation.length_m", "6", "m", "0.1 .. 100", "side of the map", false},
    {"page.map_hz",
     "10",
     "Hz",
     "0.5 .. 10",
     "largest number of maps per second for one page",
     true}};
const SettingAnswer kRefused{"page.map_hz", false, "10", "page.map_hz: '50' is outside 0.5 .. 10"};
const RecordingState kRecording{
    RecordingStage::recording, "rec/20261124T134838Z", 150, 2, 61'000'000, 10.0, "a sentence"};

const PlaybackState kPlayed{29, 600, true, 0.5};
const SteerOutcome kSteered{3, 9, "NOT_TRAVERSABLE", false, "drop of 0.17 m"};

Json example(const Json& contract, const std::string& bytes) {
    return {{"hex", testing::hex_of(bytes)}, {"fields", testing::decode(contract, bytes)}};
}

Json sequence_examples(const Json& contract) {
    Json out = Json::array();
    testing::HeldMap held;
    const std::vector<PageMap> maps = map_sequence();
    for (std::size_t i = 0; i < maps.size(); ++i) {
        Json one = example(contract, map_message(maps[i], i == 0 ? nullptr : &maps[i - 1]));
        held.take(one["fields"]);
        one["cells_after"] = held.cells;
        out.push_back(std::move(one));
    }
    return out;
}

Json request_examples() {
    const std::vector<std::string> layers = hello().layers;
    Json out = Json::array();
    for (
        const char* text :
        {R"({"op":"want","layers":["sigma_m"],"images":["left","disparity"],"map_hz":5,"image_hz":2})",
         R"({"op":"want"})",
         R"({"op":"want","map_hz":1000})",
         R"({"op":"want","layers":["no_such_layer"]})",
         R"({"op":"want","images":["right"]})",
         R"({"op":"want","map_hz":0})",
         R"({"op":"want","stairs":true,"settings":true})",
         R"({"op":"want","stairs":1})",
         R"({"op":"want","settings":"all"})",
         R"({"op":"joystick","command":9})",
         R"({"op":"joystick","command":0})",
         R"({"op":"joystick","command":256})",
         R"({"op":"joystick","command":9.5})",
         R"({"op":"joystick"})",
         R"({"op":"joystick","command":9,"now":true})",
         R"({"op":"playback","paused":true})",
         R"({"op":"playback","speed":100,"frame":12})",
         R"({"op":"playback","speed":0})",
         R"({"op":"playback","frame":-1})",
         R"({"op":"playback","frame":3000000000})",
         R"({"op":"playback","paused":1})",
         R"({"op":"playback","backwards":true})",
         R"({"op":"set","key":"page.map_hz","value":"5"})",
         R"({"op":"set","key":"page.map_hz","value":5})",
         R"({"op":"set","key":"page.map_hz"})",
         R"({"op":"set","key":"page.map_hz","value":"5","now":true})",
         R"({"op":"record","on":true})",
         R"({"op":"record","on":false})",
         R"({"op":"record","on":1})",
         R"({"op":"record"})",
         R"({"op":"dance"})",
         R"({"op":"want","op":"want"})",
         R"({"op":"want")"}) {
        const auto request = parse_request(text, layers);
        Json one{{"text", text}, {"accepted", request.ok()}};
        if (!request) {
            one["problem"] = request.error().message;
        } else if (const auto* wish = std::get_if<PageWish>(&*request)) {
            one["map_hz"] = wish->map_hz;
            one["stairs"] = wish->stairs;
            one["settings"] = wish->settings;
        } else if (const auto* word = std::get_if<JoystickWord>(&*request)) {
            one["command"] = word->command;
        } else if (const auto* play = std::get_if<PlaybackWish>(&*request)) {
            if (play->paused) one["paused"] = *play->paused;
            if (play->speed) one["speed"] = *play->speed;
            if (play->frame) one["frame"] = *play->frame;
        } else if (const auto* setting = std::get_if<SettingWish>(&*request)) {
            one["key"] = setting->key;
            one["value"] = setting->value;
        } else if (const auto* record = std::get_if<RecordWish>(&*request)) {
            one["on"] = record->on;
        }
        out.push_back(std::move(one));
    }
    return out;
}

Json all_vectors(const Json& contract) {
    PageHello stranger = hello();
    stranger.machine.reset();
    stranger.blind_zone.clear();
    PageHello shapeless = hello();  // a machine without a model
    shapeless.machine->urdf.clear();
    shapeless.machine->joints.clear();
    PagePose walking = pose();
    walking.joints_rad = {0.5F, -0.25F};
    return {
        {"about",
         "Examples of every message of messages.json, made and checked by "
         "message_vectors_test.cpp. "
         "`hex`: the bytes of a binary message; `fields`: what they say, 64-bit integers as text, "
         "NaN as null, cells as [height_mm, sigma_mm, state]. Of the maps each changes the one "
         "before; `cells_after`: all cells that the page then has."},
        {"maps", sequence_examples(contract)},
        {"poses",
         Json::array(
             {example(contract, pose_message(pose())), example(contract, pose_message(walking))})},
        {"images",
         Json::array(
             {example(contract, image_message(5, PageImage::disparity, "\xff\xd8\xff\xd9"))})},
        {"layers", Json::array({example(contract, layer_message(layer()))})},
        {"json_to_page",
         Json::array({Json::parse(hello_text(hello())),
                      Json::parse(hello_text(stranger)),
                      Json::parse(hello_text(shapeless)),
                      Json::parse(status_text(status(), std::nullopt)),
                      Json::parse(status_text(status(), kPlayed)),
                      Json::parse(steer_text(true, true, kSteered)),
                      Json::parse(stairs_text(features())),
                      Json::parse(settings_text(kSettings)),
                      Json::parse(setting_text(kRefused)),
                      Json::parse(recording_text(kRecording))})},
        {"json_to_service", request_examples()}};
}

TEST(MessageVectors, AreWhatTheServiceSends) {
    const Json made = all_vectors(testing::read_json(kContract));
    if (std::getenv("SUREFOOT_WRITE_VECTORS") != nullptr)
        std::ofstream(kVectors) << made.dump(1) << '\n';
    const Json written = testing::read_json(kVectors);
    for (const auto& [name, examples] : made.items()) {
        ASSERT_TRUE(written.contains(name)) << name;
        ASSERT_EQ(written[name].size(), examples.size()) << name;
        EXPECT_EQ(written[name], examples) << name;
    }
    EXPECT_EQ(written.size(), made.size());
}

TEST(MessageVectors, SayWhatWentIn) {
    const Json contract = testing::read_json(kContract);
    testing::HeldMap held;
    const std::vector<PageMap> maps = map_sequence();
    const std::vector<int> whole{1, 0, 0, 1};
    for (std::size_t i = 0; i < maps.size(); ++i) {
        const Json fields =
            testing::decode(contract, map_message(maps[i], i == 0 ? nullptr : &maps[i - 1]));
        EXPECT_EQ(fields["whole"], whole[i]) << i;
        EXPECT_EQ(fields["map_version"], std::to_string(maps[i].version));
        EXPECT_EQ(fields["edges"].size(), maps[i].edges.size());
        held.take(fields);
        for (std::size_t k = 0; k < maps[i].cells.size(); ++k) {
            const PageCell& cell = maps[i].cells[k];
            EXPECT_EQ(held.cells[k], Json::array({cell.height_mm, cell.sigma_mm, cell.state}))
                << "map " << i << " cell " << k;
        }
    }
    const Json said = testing::decode(contract, pose_message(pose()));
    EXPECT_EQ(said["qw"], 0.5);
    EXPECT_EQ(said["qy"], -0.5);
    EXPECT_EQ(said["sigma_x_m"], 0.25);
    EXPECT_EQ(said["sigma_y_m"], 0.5);
    EXPECT_EQ(said["health"], 1);
}

/// Every key of the contract is sent, and no other.
TEST(MessageVectors, JsonHasTheKeysOfTheContract) {
    const Json contract = testing::read_json(kContract)["json_to_page"];
    for (const std::string& text : {hello_text(hello()),
                                    status_text(status(), kPlayed),
                                    steer_text(false, true, kSteered),
                                    stairs_text(features()),
                                    settings_text(kSettings),
                                    setting_text(kRefused),
                                    recording_text(kRecording)}) {
        const Json message = Json::parse(text);
        std::vector<std::string> keys;
        for (const auto& [key, value] : message.items()) keys.push_back(key);
        const std::string kind = message["kind"].get<std::string>();
        EXPECT_EQ(Json(keys), contract[kind]["keys"]) << kind;
    }
}

std::vector<std::string> keys_of(const Json& json) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : json.items()) keys.push_back(key);
    return keys;
}

TEST(MessageVectors, ListsHaveTheKeysOfTheContract) {
    const Json contract = testing::read_json(kContract)["json_to_page"];
    const Json said = Json::parse(stairs_text(features()));
    EXPECT_EQ(Json(keys_of(said["flights"][0])), contract["stairs"]["flight"]);
    EXPECT_EQ(Json(keys_of(said["drops"][0])), contract["stairs"]["line"]);
    EXPECT_EQ(Json(keys_of(said["sills"][0])), contract["stairs"]["line"]);
    EXPECT_EQ(Json(keys_of(said["doors"][0])), contract["stairs"]["door"]);
    EXPECT_EQ(Json(keys_of(said["edges"][0])), contract["stairs"]["edge"]);
    std::vector<std::string> kerb = keys_of(said["kerbs"][0]);
    ASSERT_EQ(kerb.front(), "kind");
    kerb.erase(kerb.begin());
    EXPECT_EQ(Json(kerb), contract["stairs"]["line"]);
    const Json settings = Json::parse(settings_text(kSettings));
    EXPECT_EQ(Json(keys_of(settings["settings"][0])), contract["settings"]["setting"]);
}

}  // namespace
}  // namespace surefoot::page
