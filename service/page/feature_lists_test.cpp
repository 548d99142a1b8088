// SPDX-License-Identifier: Apache-2.0
#include "service/page/feature_lists.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace surefoot::page {
namespace {

stairs::TerrainFeatures one_flight() {
    stairs::TerrainFeatures features;
    features.time_ns = 5'000'000'000;
    stairs::Flight flight;
    flight.steps = 3;
    flight.riser_m = 0.18;
    flight.riser_sigma_m = 0.002;
    flight.tracked = {7, 4, 4'500'000'000, false};
    features.flights.push_back(flight);
    return features;
}

TEST(FeatureLists, TheMessageHasTheListsAndItsTime) {
    const auto message = gate_process::Json::parse(stairs_text(one_flight()));
    EXPECT_EQ(message["kind"], "stairs");
    EXPECT_EQ(message["time_ns"], 5'000'000'000);
    EXPECT_EQ(message["flights"][0]["riser_std_m"], 0.002);
    EXPECT_EQ(message["flights"][0]["last_seen_s"], 0.5);
    for (const char* list : {"drops", "kerbs", "sills", "doors", "edges"})
        EXPECT_TRUE(message[list].is_array() && message[list].empty()) << list;
}

TEST(FeatureLists, ThatTimePassedIsNoNews) {
    const stairs::TerrainFeatures before = one_flight();
    stairs::TerrainFeatures later = before;
    later.time_ns += 1'000'000'000;
    EXPECT_TRUE(say_the_same(before, later));
    later.flights[0].riser_m = 0.181;
    EXPECT_FALSE(say_the_same(before, later));
    later = before;
    later.drops.emplace_back();
    EXPECT_FALSE(say_the_same(before, later));
}

}  // namespace
}  // namespace surefoot::page
