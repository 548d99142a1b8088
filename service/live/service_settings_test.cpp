// SPDX-License-Identifier: Apache-2.0
#include "service/live/service_settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace surefoot::app {
namespace {

/// A service whose changes are kept here; it refuses what `refusal` says.
struct Bench {
    ServiceConfig applied;
    int count = 0;
    std::string refusal;
    ServiceSettings settings{ServiceConfig{}, true, [this](const ServiceConfig& wanted) -> Status {
                                 if (!refusal.empty()) return usage_error(refusal);
                                 applied = wanted;
                                 ++count;
                                 return {};
                             }};

    std::string refused(const std::string& key, const std::string& value) {
        const auto changed = settings.change({key, value});
        return changed ? "accepted" : changed.error().message;
    }
};

TEST(ServiceSettings, AChangeIsAppliedAndKept) {
    Bench bench;
    EXPECT_EQ(bench.settings.change({"page.map_hz", "2.5"}).value(), "2.5");
    EXPECT_EQ(bench.settings.change({"service.niceness", "15"}).value(), "15");
    EXPECT_EQ(bench.applied.map_hz, 2.5);
    EXPECT_EQ(bench.applied.niceness, 15);
    EXPECT_EQ(bench.settings.now().map_hz, 2.5);
}

TEST(ServiceSettings, WhatIsOutOfRangeOrNoNumberIsRefusedInWords) {
    Bench bench;
    EXPECT_EQ(bench.refused("page.map_hz", "50"), "page.map_hz: '50' is outside 0.2 .. 10");
    EXPECT_EQ(bench.refused("page.image_hz", "fast"), "page.image_hz: 'fast' is not a number");
    EXPECT_EQ(bench.refused("service.niceness", "20"), "service.niceness: '20' is outside 0 .. 19");
    EXPECT_NE(bench.refused("stereo.disparities", "64").find("unknown key"), std::string::npos);
    EXPECT_EQ(bench.count, 0);
}

TEST(ServiceSettings, PerceptionNeverGetsMoreThanItBeganWith) {
    Bench bench;
    EXPECT_NE(bench.refused("service.niceness", "5").find("started with --nice 10"),
              std::string::npos);
    ASSERT_TRUE(bench.settings.change({"service.niceness", "19"}).ok());
    EXPECT_TRUE(bench.settings.change({"service.niceness", "10"}).ok());
}

TEST(ServiceSettings, WhatTheSystemRefusesStaysAsItWas) {
    Bench bench;
    bench.refusal = "not permitted";
    EXPECT_EQ(bench.refused("service.niceness", "15"), "not permitted");
    EXPECT_EQ(bench.settings.now().niceness, 10);
}

TEST(ServiceSettings, PagesSeeEverySettingOfTheRunAndChangeNoneOfThem) {
    Settings run;
    run.pipeline.elevation.length_m = 7.5;
    const auto all = Bench().settings.for_pages(run);
    std::set<std::string> changeable;
    for (const page::PageSetting& setting : all) {
        if (setting.changeable) changeable.insert(setting.key);
    }
    EXPECT_EQ(
        changeable,
        (std::set<std::string>{
            "page.image_hz", "page.layer_hz", "page.map_hz", "service.niceness", "service.speed"}));
    EXPECT_EQ(all.size(), changeable.size() + io::list_config_of(run).size());
    const auto length = std::find_if(
        all.begin(), all.end(), [](const auto& s) { return s.key == "elevation.length_m"; });
    ASSERT_NE(length, all.end());
    EXPECT_EQ(length->value, "7.5");
    EXPECT_EQ(length->unit, "m");
}

TEST(ServiceSettings, OnlyASimulatedSceneHasASpeedHere) {
    const ServiceSettings settings({}, false, [](const ServiceConfig&) { return Status(); });
    for (const page::PageSetting& setting : settings.for_pages({}))
        EXPECT_NE(setting.key, "service.speed");
}

TEST(ServiceSettings, UnitsAreTheEndsOfNames) {
    EXPECT_EQ(unit_of("elevation.length_m"), "m");
    EXPECT_EQ(unit_of("elevation.min_height_var_m2"), "m\u00b2");
    EXPECT_EQ(unit_of("page.map_hz"), "Hz");
    EXPECT_EQ(unit_of("level.max_slew_deg_s"), "deg/s");
    EXPECT_EQ(unit_of("stereo.disparities"), "");
    EXPECT_EQ(unit_of("mount.enabled"), "");
}

}  // namespace
}  // namespace surefoot::app
