// SPDX-License-Identifier: Apache-2.0
// The names of settings of version 0.1 still work, with a note that names the new one.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot {
namespace {

using OldAndNew = std::pair<std::string, std::string>;

/// docs/migration.md, one setting of each row.
const std::vector<OldAndNew> kPairs{
    {"trim.enabled=false", "self_calibration.enabled=false"},
    {"stairs.follow.mean_looks=7", "stairs.tracking.mean_observations=7"},
    {"stairs.follow.going_looks=9", "stairs.tracking.going_observations=9"},
    {"stairs.follow.level_looks=7", "stairs.tracking.level_observations=7"},
    {"stairs.follow.missed_looks=7", "stairs.tracking.missed_observations=7"},
    {"stairs.follow.first_looks=7", "stairs.tracking.first_observations=7"},
    {"stairs.follow.steps_looks=9", "stairs.tracking.steps_observations=9"},
    {"specular.forget_looks=7", "specular.forget_observations=7"},
    {"mount.wait_for_light_s=7", "mount.wait_for_exposure_s=7"},
    {"sim.carrier=rex", "sim.motion_model=rex"},
    {"sim.optics.smudge_eye=right", "sim.optics.smudge_camera=right"},
};

SettingsRequest overridden(std::vector<std::string> overrides) {
    SettingsRequest request;
    request.overrides = std::move(overrides);
    return request;
}

TEST(RenamedSettings, OldNamesOfOverridesGiveTheSameSettingsAndANote) {
    const std::uint64_t usual = hash_of(Settings{});
    for (const auto& [old_name, new_name] : kPairs) {
        io::Notes notes;
        io::Notes no_notes;
        const auto by_old = load_settings(overridden({old_name}), &notes);
        const auto by_new = load_settings(overridden({new_name}), &no_notes);
        ASSERT_TRUE(by_old.ok()) << by_old.error().message;
        ASSERT_TRUE(by_new.ok()) << by_new.error().message;
        EXPECT_EQ(hash_of(*by_old), hash_of(*by_new)) << old_name;
        EXPECT_NE(hash_of(*by_old), usual) << old_name << " must change something";
        ASSERT_EQ(notes.size(), 1U) << old_name;
        const std::string key = new_name.substr(0, new_name.find('='));
        EXPECT_NE(notes[0].find("'" + key + "'"), std::string::npos) << notes[0];
        EXPECT_TRUE(no_notes.empty()) << no_notes[0];
    }
}

TEST(RenamedSettings, OldGroupsOfAFileAreReadWithTheirLines) {
    const std::string text =
        "trim:\n  enabled: false\nstairs:\n  follow:\n    mean_looks: 7\nsim.carrier: rex\n";
    Settings settings;
    io::Notes notes;
    const Status read = io::parse_config(text, "old.yaml", io::describe_config(settings), &notes);
    ASSERT_TRUE(read.ok()) << read.error().message;
    const auto wanted = load_settings(overridden({"self_calibration.enabled=false",
                                                  "stairs.tracking.mean_observations=7",
                                                  "sim.motion_model=rex"}));
    ASSERT_TRUE(wanted.ok());
    EXPECT_EQ(hash_of(settings), hash_of(*wanted));
    ASSERT_EQ(notes.size(), 4U);
    EXPECT_TRUE(notes[0].starts_with("old.yaml:1: 'trim' is now called 'self_calibration'"))
        << notes[0];
}

TEST(RenamedSettings, BothNamesOfOneSettingAreAnError) {
    Settings settings;
    const Status read = io::parse_config("trim.enabled: false\nself_calibration.enabled: true\n",
                                         "both.yaml",
                                         io::describe_config(settings));
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("appears twice"), std::string::npos)
        << read.error().message;
}

TEST(RenamedSettings, UnknownKeysStayErrors) {
    EXPECT_FALSE(load_settings(overridden({"trim.nothing=1"})).ok());
    EXPECT_FALSE(load_settings(overridden({"trimmed.enabled=false"})).ok());
}

TEST(SettingsHash, CoversKeysAndValuesButNoDescription) {
    const Settings usual;
    std::string text;
    for (const io::ConfigEntry& entry : io::list_config_of(usual))
        text += entry.key + "=" + entry.value + "\n";
    EXPECT_EQ(hash_of(usual), fnv1a(text));
    Settings other = usual;
    other.pipeline.elevation.resolution_m *= 2.0;
    EXPECT_NE(hash_of(other), hash_of(usual));
}

}  // namespace
}  // namespace surefoot
