// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/config_yaml.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

enum class Rule { mean, worst };

struct InnerConfig {
    double length_m = 6.0;
    double resolution_m = 0.025;
    Rule rule = Rule::mean;
    void describe(ConfigVisitor& visitor) {
        static constexpr const char* kNames[] = {"mean", "worst"};
        visitor.number("length_m", length_m, 0.5, 100.0, "side of the map");
        visitor.number("resolution_m", resolution_m, 1e-3, 1.0, "side of a cell");
        visitor.enumeration("rule", rule, kNames, "how to combine");
    }
};

struct TopConfig {
    InnerConfig elevation;
    int disparities = 64;
    bool chunking = true;
    double weight = 1.0 / 3.0;
    void describe(ConfigVisitor& visitor) {
        visitor.group("elevation", elevation);
        visitor.integer("disparities", disparities, 16, 512, "search range");
        visitor.begin_group("deep");
        visitor.begin_group("deeper");
        visitor.boolean("chunking", chunking, "cut into pieces");
        visitor.end_group();
        visitor.end_group();
        visitor.number("weight", weight, -1e300, 1e300, "any");
    }
};

std::string message_of(const std::string& yaml) {
    TopConfig config;
    const Status status = parse_config(yaml, "my.yaml", describe_config(config));
    EXPECT_FALSE(status.ok()) << yaml;
    if (status.ok()) return {};
    EXPECT_EQ(status.error().code, ErrorCode::usage);
    return status.error().message;
}

TEST(ConfigYaml, ReadsNestedAndDottedKeysAndKeepsTheRest) {
    TopConfig config;
    const std::string yaml =
        "elevation:\n  length_m: 40   # the road\n  rule: worst\nelevation.resolution_m: 0.1\n"
        "deep:\n  deeper: {chunking: false}\n";
    const Status status = parse_config(yaml, "my.yaml", describe_config(config));
    ASSERT_TRUE(status.ok()) << status.error().message;
    EXPECT_EQ(config.elevation.length_m, 40.0);
    EXPECT_EQ(config.elevation.resolution_m, 0.1);
    EXPECT_EQ(config.elevation.rule, Rule::worst);
    EXPECT_FALSE(config.chunking);
    EXPECT_EQ(config.disparities, 64);
}

TEST(ConfigYaml, UnknownKeyNamesFileLineAndTheNearestKey) {
    EXPECT_EQ(message_of("disparities: 64\nelevation:\n  lenght_m: 3\n"),
              "my.yaml:3: unknown key 'elevation.lenght_m'; did you mean 'elevation.length_m'?");
    EXPECT_TRUE(contains(message_of("elevaton:\n  length_m: 3\n"),
                         "my.yaml:1: unknown key 'elevaton.length_m'; did you mean "
                         "'elevation.length_m'"));
    EXPECT_TRUE(contains(message_of("deep:\n  deeper:\n    length_m: 3\n"),
                         "my.yaml:3: unknown key 'deep.deeper.length_m'"));
}

TEST(ConfigYaml, WrongValuesNameTheKeyTheValueAndTheLimit) {
    EXPECT_EQ(message_of("elevation:\n  length_m: 1000\n"),
              "my.yaml:2: elevation.length_m: '1000' is outside 0.5 .. 100");
    EXPECT_TRUE(
        contains(message_of("elevation: {length_m: .nan}"), "'.nan' is outside 0.5 .. 100"));
    EXPECT_TRUE(contains(message_of("elevation: {length_m: 3m}"), "'3m' is not a number"));
    EXPECT_TRUE(contains(message_of("elevation: {length_m: '3,5'}"), "'3,5' is not a number"));
    EXPECT_TRUE(contains(message_of("elevation: {length_m: [3]}"), "expected a single value"));
    EXPECT_TRUE(contains(message_of("elevation: 3"), "expected a group of keys"));
    EXPECT_TRUE(contains(message_of("disparities: 64.5"), "'64.5' is not a whole number"));
    EXPECT_TRUE(contains(message_of("disparities: 5000"), "'5000' is outside 16 .. 512"));
    EXPECT_TRUE(contains(message_of("elevation: {rule: median}"), "is not one of mean | worst"));
    EXPECT_TRUE(contains(message_of("deep: {deeper: {chunking: yes}}"), "neither true nor false"));
    EXPECT_TRUE(contains(message_of("disparities: 32\ndisparities: 64"), "appears twice"));
    EXPECT_TRUE(contains(message_of("elevation: {length_m: 3}\nelevation.length_m: 4"), "twice"));
    EXPECT_TRUE(contains(message_of("weight: 1e999"), "not a number"));
    EXPECT_TRUE(contains(message_of("weight: .inf"), "outside"));
    EXPECT_TRUE(contains(message_of("elevation: {length_m: 3\n"), "my.yaml:2: not valid YAML"));
    EXPECT_TRUE(contains(message_of("- 3\n"), "expected 'key: value' lines, found a list"));
}

TEST(ConfigYaml, AnErrorLeavesTheConfigUnchanged) {
    TopConfig config;
    const Status status =
        parse_config("disparities: 128\nweight: abc\n", "my.yaml", describe_config(config));
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(config.disparities, 64);
}

TEST(ConfigYaml, OverridesFollowTheSameRules) {
    TopConfig config;
    for (const char* setting : {"elevation.length_m=40", "deep.deeper.chunking=false"})
        ASSERT_TRUE(override_config(setting, describe_config(config)).ok()) << setting;
    EXPECT_EQ(config.elevation.length_m, 40.0);
    EXPECT_FALSE(config.chunking);
    const auto message = [&](const char* text) {
        const Status status = override_config(text, describe_config(config));
        return status.ok() ? std::string("accepted") : status.error().message;
    };
    EXPECT_EQ(message("elevation.lenght_m=3"),
              "--set: unknown key 'elevation.lenght_m'; did you mean 'elevation.length_m'?");
    EXPECT_EQ(message("elevation.length_m=0"),
              "--set: elevation.length_m: '0' is outside 0.5 .. 100");
    EXPECT_EQ(message("elevation"), "--set 'elevation': expected key=value");
    EXPECT_TRUE(contains(message("elevation=3"), "unknown key 'elevation'"));
}

TEST(ConfigYaml, AChangeFromElsewhereIsNoOptionOfACall) {
    TopConfig config;
    ASSERT_TRUE(change_config("elevation.length_m", "40", describe_config(config)).ok());
    EXPECT_EQ(config.elevation.length_m, 40.0);
    EXPECT_EQ(change_config("elevation.length_m", "0", describe_config(config)).error().message,
              "elevation.length_m: '0' is outside 0.5 .. 100");
    EXPECT_EQ(config.elevation.length_m, 40.0);
    EXPECT_EQ(change_config("elevation.lenght_m", "3", describe_config(config)).error().message,
              "unknown key 'elevation.lenght_m'; did you mean 'elevation.length_m'?");
}

TEST(ConfigYaml, WritingAndReadingKeepsEveryBit) {
    Rng rng(7);
    for (int round = 0; round < 500; ++round) {
        TopConfig original;
        original.weight = std::bit_cast<double>(rng.next_u64());
        if (!(std::abs(original.weight) < 1e300)) original.weight = rng.normal();
        original.elevation.length_m = rng.uniform(0.5, 100.0);
        original.elevation.rule = rng.below(2) == 0 ? Rule::mean : Rule::worst;
        original.disparities = static_cast<int>(16 + rng.below(497));
        original.chunking = rng.below(2) == 0;
        TopConfig copy;
        const std::string yaml = format_config_of(original);
        const Status status = parse_config(yaml, "copy.yaml", describe_config(copy));
        ASSERT_TRUE(status.ok()) << status.error().message << "\n" << yaml;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(copy.weight),
                  std::bit_cast<std::uint64_t>(original.weight))
            << yaml;
        ASSERT_EQ(copy.elevation.length_m, original.elevation.length_m);
        ASSERT_EQ(copy.elevation.rule, original.elevation.rule);
        ASSERT_EQ(copy.disparities, original.disparities);
        ASSERT_EQ(copy.chunking, original.chunking);
    }
}

TEST(ConfigYaml, ListsEveryKeyWithRangeAndComment) {
    const auto entries = list_config_of(TopConfig{});
    ASSERT_EQ(entries.size(), 6U);
    EXPECT_EQ(entries[0].key, "elevation.length_m");
    EXPECT_EQ(entries[0].value, "6");
    EXPECT_EQ(entries[0].range, "0.5 .. 100");
    EXPECT_EQ(entries[2].range, "mean | worst");
    EXPECT_EQ(entries[4].key, "deep.deeper.chunking");
    EXPECT_TRUE(contains(format_config_of(TopConfig{}), "# side of the map (0.5 .. 100)"));
}

TEST(ConfigYaml, FilesThatCannotBeReadOrWrittenAreNamed) {
    TopConfig config;
    const Status missing = read_config_into("/nowhere/my.yaml", config);
    ASSERT_FALSE(missing.ok());
    EXPECT_TRUE(contains(missing.error().message, "/nowhere/my.yaml: cannot read: No such file"));
    const Status full = write_config_of("/dev/full", config);
    ASSERT_FALSE(full.ok());
    EXPECT_TRUE(contains(full.error().message, "/dev/full: cannot write: No space left"));
}

TEST(ConfigYaml, SurvivesDamagedFiles) {
    testing::for_each_mutation(
        format_config_of(TopConfig{}), 3000, 11, [](const std::string& text) {
            TopConfig config;
            const Status status = parse_config(text, "damaged.yaml", describe_config(config));
            if (status.ok()) {
                EXPECT_TRUE(config.elevation.length_m >= 0.5 && config.elevation.length_m <= 100.0);
                EXPECT_TRUE(config.disparities >= 16 && config.disparities <= 512);
            } else {
                EXPECT_TRUE(contains(status.error().message, "damaged.yaml"));
            }
        });
}

}  // namespace
}  // namespace surefoot::io
