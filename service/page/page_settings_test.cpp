// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_settings.hpp"

#include <gtest/gtest.h>

namespace surefoot::page {
namespace {

std::vector<PageSetting> two_settings() {
    return {{"elevation.length_m", "6", "m", "0.1 .. 100", "side of the map", false},
            {"page.map_hz", "10", "Hz", "0.5 .. 10", "maps", true}};
}

TEST(PageSettings, NothingCanBeChangedBeforeItIsOffered) {
    PageSettings settings;
    EXPECT_EQ(settings.serial(), 0U);
    const SettingAnswer answer = settings.ask({"page.map_hz", "5"});
    EXPECT_FALSE(answer.accepted);
    EXPECT_EQ(answer.text, "there is no setting 'page.map_hz'");
}

TEST(PageSettings, AChangeIsMadeAndShownToAll) {
    PageSettings settings;
    settings.offer(two_settings(), [](const SettingWish& wish) { return Result(wish.value); });
    const std::uint64_t before = settings.serial();
    const SettingAnswer answer = settings.ask({"page.map_hz", "5"});
    EXPECT_TRUE(answer.accepted);
    EXPECT_EQ(answer.value, "5");
    EXPECT_EQ(answer.text, "page.map_hz is now 5 (before: 10)");
    EXPECT_EQ(settings.all()[1].value, "5");
    EXPECT_GT(settings.serial(), before);
}

TEST(PageSettings, WhatNeedsARestartIsNeverAskedFor) {
    PageSettings settings;
    bool asked = false;
    settings.offer(two_settings(), [&](const SettingWish& wish) {
        asked = true;
        return Result(wish.value);
    });
    const std::uint64_t before = settings.serial();
    const SettingAnswer answer = settings.ask({"elevation.length_m", "8"});
    EXPECT_FALSE(answer.accepted);
    EXPECT_FALSE(asked);
    EXPECT_EQ(answer.value, "6");
    EXPECT_NE(answer.text.find("--set elevation.length_m=8"), std::string::npos) << answer.text;
    EXPECT_EQ(settings.serial(), before);
}

TEST(PageSettings, ARefusalKeepsTheValueAndSaysWhy) {
    PageSettings settings;
    settings.offer(two_settings(), [](const SettingWish&) -> Result<std::string> {
        return usage_error("'50' is outside 0.5 .. 10");
    });
    const std::uint64_t before = settings.serial();
    const SettingAnswer answer = settings.ask({"page.map_hz", "50"});
    EXPECT_FALSE(answer.accepted);
    EXPECT_EQ(answer.value, "10");
    EXPECT_EQ(answer.text, "'50' is outside 0.5 .. 10");
    EXPECT_EQ(settings.serial(), before);
}

}  // namespace
}  // namespace surefoot::page
