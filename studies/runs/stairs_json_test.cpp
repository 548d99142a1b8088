// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/stairs_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "studies/runs/run_features.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::app {
namespace {

/// Removes blanks and line breaks.
std::string packed(const std::string& json) {
    std::string text;
    for (const char c : json)
        if (c != ' ' && c != '\n') text += c;
    return text;
}

std::string json_of(const stairs::TerrainFeatures& features,
                    const std::vector<std::string>& assumed) {
    return stairs_json(
        features,
        {},
        {.resolution_m = 0.025, .gravity_source = grid::GravitySource::imu, .assumed = assumed});
}

stairs::LineFeature line(double height_m) {
    stairs::LineFeature line;
    line.pose = {{1.5, -0.5, 0.25}, 0.125};
    line.height_m = height_m;
    line.length_m = 2.0;
    line.sigma_m = 0.5;
    return line;
}

stairs::Edge edge() {
    stairs::Edge edge;
    edge.from_m = {1.0, 2.0};
    edge.to_m = {3.0, 4.0};
    edge.upper_m = 0.5;
    edge.lower_m = -0.25;
    edge.height_sigma_m = 0.125;
    return edge;
}

std::string pose_text() {
    return R"("pose":[1.5,-0.5,0.25,0.125])";
}

std::string no_cells() {
    std::string text = R"("classes":{)";
    for (const char* name : stairs::kGroundClassNames)
        text += std::string(text.back() == '{' ? "" : ",") + '"' + name +
                R"(":{"cells":0,"area_m2":0.0})";
    return text + "},";
}

TEST(StairsJson, CellsAreCountedByTheirClass) {
    stairs::GroundClasses classes;
    classes.of_cell = Image<stairs::GroundClass>(4, 2, stairs::GroundClass::floor);
    classes.of_cell.at(1, 1) = stairs::GroundClass::unknown;
    classes.of_cell.at(2, 1) = classes.of_cell.at(3, 1) = stairs::GroundClass::tunnel;
    const std::string json = packed(stairs_json({}, classes, {.resolution_m = 0.5}));
    for (const char* part : {R"("classes":{"unknown":{"cells":1,"area_m2":0.25},)",
                             R"("floor":{"cells":5,"area_m2":1.25})",
                             R"("tread":{"cells":0,"area_m2":0.0})",
                             R"("tunnel":{"cells":2,"area_m2":0.5}})"})
        EXPECT_NE(json.find(part), std::string::npos) << part << '\n' << json;
}

TEST(StairsJson, NothingIsEmptyLists) {
    EXPECT_EQ(packed(json_of({}, {})),
              R"({"flights":[],"drops":[],"kerbs":[],"sills":[],"doors":[],"edges":[],)" +
                  no_cells() + R"("assumed":[],"gravity_source":"imu"})");
}

TEST(StairsJson, AFlightHasEveryNameOfTheContract) {
    stairs::Flight flight;
    flight.kind = stairs::FlightKind::down;
    flight.pose = {{1.5, -0.5, 0.25}, 0.125};
    flight.steps = 3;
    flight.riser_m = 0.25;
    flight.riser_sigma_m = 0.5;
    flight.riser_spread_m = 0.75;
    flight.going_m = 1.25;
    flight.going_sigma_m = 1.5;
    flight.going_spread_m = 1.75;
    flight.width_m = 2.25;
    flight.landing_m = 2.5;
    flight.turn_rad = 2.75;
    flight.cut = true;
    flight.open = true;
    flight.left = {stairs::SideKind::wall, 0.0};
    flight.right = {stairs::SideKind::open, 0.875};
    stairs::TerrainFeatures features;
    features.flights = {flight};
    EXPECT_NE(packed(json_of(features, {}))
                  .find(R"({"flights":[{"kind":"down","steps":3,"riser_m":0.25,"riser_std_m":0.5,)"
                        R"("riser_spread_m":0.75,"going_m":1.25,"going_std_m":1.5,)"
                        R"("going_spread_m":1.75,"width_m":2.25,"landing_m":2.5,"turn_rad":2.75,)"
                        R"("cut":true,"open":true,"left":{"kind":"wall","rail_m":null},)"
                        R"("right":{"kind":"open","rail_m":0.875},)" +
                        pose_text() + R"(,"log10_step_ratio":null}],)"),
              std::string::npos)
        << json_of(features, {});
}

TEST(StairsJson, WhatIsNoNumberIsNull) {
    stairs::TerrainFeatures features;
    stairs::Flight one;
    one.steps = 1;
    one.going_m = one.going_sigma_m = one.going_spread_m = kNan;
    features.flights = {one};
    stairs::Door door;
    door.clearance_m = kNan;
    features.doors = {door};
    const std::string json = packed(json_of(features, {}));
    EXPECT_NE(json.find(R"("kind":"up","steps":1)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"("going_m":null,"going_std_m":null,"going_spread_m":null)"),
              std::string::npos)
        << json;
    EXPECT_NE(json.find(R"("clearance_m":null)"), std::string::npos) << json;
}

TEST(StairsJson, DropsAndKerbsHavePositiveHeights) {
    stairs::TerrainFeatures features;
    stairs::LineFeature drop = line(-0.75);
    drop.bottom_seen = false;
    features.drops = {drop};
    features.kerbs = {line(-0.25), line(0.25)};
    features.sills = {line(0.5)};
    const auto common = [](const char* height, const char* seen) {
        return pose_text() + R"(,"height_m":)" + height +
               R"(,"length_m":2.0,"sigma_m":0.5,"bottom_seen":)" + seen +
               R"(,"log10_step_ratio":null})";
    };
    const std::string json = packed(json_of(features, {}));
    EXPECT_NE(
        json.find(R"("drops":[{)" + common("0.75", "false") + R"(],"kerbs":[{"kind":"down",)" +
                  common("0.25", "true") + R"(,{"kind":"up",)" + common("0.25", "true") +
                  R"(],"sills":[{)" + common("0.5", "true") + "]"),
        std::string::npos)
        << json;
}

TEST(StairsJson, WhatWasFollowedHasAnIdAndHowOftenAndHowLongAgoItWasSeen) {
    const stairs::Tracked tracked{
        .id = 7, .observations = 12, .last_seen_ns = 1'500'000'000, .seen_now = false};
    stairs::TerrainFeatures features;
    features.time_ns = 4'000'000'000;
    features.flights.emplace_back().tracked = tracked;
    features.drops.emplace_back().tracked = tracked;
    features.kerbs.emplace_back().tracked = tracked;
    features.sills.emplace_back().tracked = tracked;
    features.doors.emplace_back().tracked = tracked;
    features.edges.emplace_back().tracked = tracked;
    const std::string json = packed(json_of(features, {}));
    const std::string said = R"("id":7,"observations":12,"last_seen_s":2.5)";
    int times = 0;
    for (std::size_t at = json.find(said); at != std::string::npos; at = json.find(said, at + 1))
        ++times;
    EXPECT_EQ(times, 6) << json;
}

TEST(StairsJson, DoorsEdgesAndWhatWasAssumed) {
    stairs::TerrainFeatures features;
    stairs::Door door;
    door.pose = {{1.5, -0.5, 0.25}, 0.125};
    door.width_m = 0.75;
    door.width_sigma_m = 0.5;
    door.sill_m = 0.25;
    door.clearance_m = 2.0;
    features.doors = {door};
    features.edges = {edge()};
    EXPECT_NE(
        packed(json_of(features, {"z is \"up\""}))
            .find(R"("doors":[{"width_m":0.75,"width_std_m":0.5,"sill_m":0.25,"clearance_m":2.0,)" +
                  pose_text() +
                  R"(}],"edges":[{"from":[1.0,2.0],"to":[3.0,4.0],"upper_m":0.5,"lower_m":-0.25,)"
                  R"("lower_seen":false,"sigma_m":0.125,"log10_step_ratio":null}],)" +
                  no_cells() + R"("assumed":["zis\"up\""],"gravity_source":"imu"})"),
        std::string::npos)
        << json_of(features, {});
}

TEST(StairsJson, EachEdgeStatesHowMuchMoreLikelyAStepItIsThanSmoothGround) {
    stairs::TerrainFeatures features;
    features.edges = {edge()};
    features.edges[0].log_step_ratio = 2.5 * std::log(10.0);
    features.drops = {stairs::line_feature(features.edges[0], true)};
    stairs::Flight flight;
    flight.edges = {edge(), features.edges[0], edge()};
    flight.edges[0].log_step_ratio = 4.0 * std::log(10.0);  // the third edge has no ratio
    features.flights = {flight};
    const std::string json = packed(json_of(features, {}));
    int times = 0;
    const std::string said = R"("log10_step_ratio":2.5)";
    for (std::size_t at = json.find(said); at != std::string::npos; at = json.find(said, at + 1))
        ++times;
    EXPECT_EQ(times, 3) << "edge, drop and flight, which is as sure as its least sure step\n"
                        << json;
}

TEST(StairsJson, WhereGravityWasAssumedEachFeatureSaysSo) {
    stairs::TerrainFeatures features;
    features.flights.emplace_back();
    features.drops.emplace_back();
    features.kerbs.emplace_back();
    features.doors.emplace_back();
    features.edges = {edge()};
    const auto marks = [&](grid::GravitySource source) {
        const std::string json =
            packed(stairs_json(features, {}, {.resolution_m = 0.025, .gravity_source = source}));
        const std::string named = std::string(R"("gravity_source":")") + gravity_name(source) + '"';
        EXPECT_NE(json.find(named), std::string::npos) << json;
        int times = 0;
        const std::string said = R"("gravity_assumed":true)";
        for (std::size_t at = json.find(said); at != std::string::npos;
             at = json.find(said, at + 1))
            ++times;
        return times;
    };
    EXPECT_EQ(marks(grid::GravitySource::assumed), 5);
    EXPECT_EQ(marks(grid::GravitySource::plane), 0);
    EXPECT_EQ(marks(grid::GravitySource::imu), 0);
    EXPECT_FALSE(gravity_note(grid::GravitySource::assumed).empty());
    EXPECT_TRUE(gravity_note(grid::GravitySource::imu).empty());
}

stairs::LineFeature seen(double x_m, int observations) {
    stairs::LineFeature drop = line(-0.5);
    drop.pose.p_m.x() = x_m;
    drop.tracked = {.id = 3, .observations = observations, .last_seen_ns = 0, .seen_now = true};
    return drop;
}

TEST(RunFeatures, WhatWasSeenOnceIsUnconfirmedAndTheFinalMapIsToldApart) {
    stairs::TerrainFeatures tracked;
    tracked.drops = {seen(1.0, 5), seen(3.0, 4), seen(5.0, 1)};
    stairs::TerrainFeatures final_map;
    final_map.drops = {seen(1.05, 1), seen(9.0, 1)};
    for (stairs::LineFeature& drop : final_map.drops) drop.tracked = {};
    const RunFeatures said = compare_with_final_map(tracked, final_map);
    ASSERT_EQ(said.confirmed.drops.size(), 2U);
    EXPECT_EQ(said.confirmed.drops[0].tracked.in_final_map, true);
    EXPECT_EQ(said.confirmed.drops[1].tracked.in_final_map, false) << "remembered, not in the map";
    ASSERT_EQ(said.unconfirmed.drops.size(), 2U) << "no drop is left out";
    EXPECT_EQ(said.unconfirmed.drops[0].tracked.in_final_map, false);
    EXPECT_EQ(said.unconfirmed.drops[1].tracked.observations, 0) << "the final map alone has it";
    EXPECT_EQ(said.unconfirmed.drops[1].tracked.in_final_map, true);
    const std::string json = packed(
        stairs_json(said.confirmed, {}, {.resolution_m = 0.025, .unconfirmed = &said.unconfirmed}));
    EXPECT_NE(json.find(R"("unconfirmed":{"flights":[],"drops":[{)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"("observations":0,"in_final_map":true)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"("in_final_map":false)"), std::string::npos) << json;
}

TEST(StairsJson, WhatIsWrittenIsRead) {
    stairs::TerrainFeatures features;
    stairs::Flight flight;
    flight.kind = stairs::FlightKind::down;
    flight.pose = {{1.5, -0.5, 0.25}, 0.125};
    flight.steps = 1;
    flight.riser_m = 0.25;
    flight.going_m = kNan;
    flight.width_m = 2.25;
    features.flights = {flight};
    features.drops = {line(-0.5)};
    features.drops[0].bottom_seen = false;
    features.kerbs = {line(0.125), line(-0.125)};
    features.sills = {line(0.0625)};
    stairs::Door door;
    door.pose = {{3.5, 0.5, 0.0}, -0.25};
    door.width_m = 0.875;
    door.sill_m = 0.0;
    door.clearance_m = kNan;
    features.doors = {door};
    features.edges = {edge()};
    const auto read = parse_stairs(json_of(features, {}), "stairs.json");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->lists.size(), 6U);
    const stairs::TerrainFeatures& again = read->features;
    ASSERT_EQ(again.flights.size(), 1U);
    EXPECT_EQ(again.flights[0].kind, stairs::FlightKind::down);
    EXPECT_EQ(again.flights[0].pose.p_m, flight.pose.p_m);
    EXPECT_EQ(again.flights[0].pose.yaw_rad, 0.125);
    EXPECT_EQ(again.flights[0].steps, 1);
    EXPECT_EQ(again.flights[0].riser_m, 0.25);
    EXPECT_TRUE(std::isnan(again.flights[0].going_m));
    EXPECT_EQ(again.flights[0].width_m, 2.25);
    ASSERT_EQ(again.drops.size(), 1U);
    EXPECT_EQ(again.drops[0].height_m, -0.5);
    EXPECT_FALSE(again.drops[0].bottom_seen);
    EXPECT_EQ(again.drops[0].length_m, 2.0);
    ASSERT_EQ(again.kerbs.size(), 2U);
    EXPECT_EQ(again.kerbs[0].height_m, 0.125);
    EXPECT_EQ(again.kerbs[1].height_m, -0.125);
    EXPECT_TRUE(again.kerbs[0].bottom_seen);
    ASSERT_EQ(again.sills.size(), 1U);
    EXPECT_EQ(again.sills[0].height_m, 0.0625);
    ASSERT_EQ(again.doors.size(), 1U);
    EXPECT_EQ(again.doors[0].width_m, 0.875);
    EXPECT_EQ(again.doors[0].sill_m, 0.0);
    EXPECT_EQ(again.doors[0].pose.yaw_rad, -0.25);
    ASSERT_EQ(again.edges.size(), 1U);
    EXPECT_EQ(again.edges[0].from_m, edge().from_m);
    EXPECT_EQ(again.edges[0].to_m, edge().to_m);
    EXPECT_EQ(again.edges[0].upper_m, 0.5);
    EXPECT_EQ(again.edges[0].lower_m, -0.25);
    EXPECT_FALSE(again.edges[0].lower_seen);
}

}  // namespace
}  // namespace surefoot::app
