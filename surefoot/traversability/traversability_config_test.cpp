// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability_config.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace surefoot::traversability {
namespace {

/// Collects "group.key" -> value and checks that every value lies within its range.
class Collect final : public ConfigVisitor {
  public:
    std::map<std::string, double> values;

    void begin_group(const char* name) override { prefix_ += std::string(name) + "."; }
    void end_group() override { prefix_.erase(prefix_.rfind('.', prefix_.size() - 2) + 1); }
    void number(const char* key, double& value, double min, double max, const char*) override {
        EXPECT_GE(value, min) << prefix_ << key;
        EXPECT_LE(value, max) << prefix_ << key;
        values[prefix_ + key] = value;
    }
    void integer(const char* key, int& value, int min, int max, const char*) override {
        EXPECT_GE(value, min) << prefix_ << key;
        EXPECT_LE(value, max) << prefix_ << key;
        values[prefix_ + key] = value;
    }
    void boolean(const char* key, bool&, const char*) override { ADD_FAILURE() << key; }
    void choice(const char* key,
                int& value,
                std::span<const char* const> names,
                const char*) override {
        EXPECT_LT(static_cast<std::size_t>(value), names.size());
        values[prefix_ + key] = value;
    }

  private:
    std::string prefix_;
};

std::map<std::string, double> described(TraversabilityConfig config) {
    Collect collect;
    collect.group("traversability", config);
    return collect.values;
}

TEST(TraversabilityConfig, KeysAreThoseThatScriptsRelyOn) {
    const auto values = described(TraversabilityConfig{});
    for (const char* key : {"normals.radius_m",
                            "slope.critical_rad",
                            "step.critical_m",
                            "step.first_radius_m",
                            "step.second_radius_m",
                            "step.critical_cells",
                            "roughness.critical_m",
                            "roughness.radius_m",
                            "weights.slope",
                            "weights.step",
                            "weights.roughness",
                            "combine",
                            "reach.max_step_m",
                            "reach.stance_radius_m",
                            "confidence.safe_threshold",
                            "confidence.independent_cells",
                            "resolve.step_m",
                            "resolve.radius_m"}) {
        EXPECT_TRUE(values.contains(std::string("traversability.") + key)) << key;
    }
    EXPECT_EQ(values.size(), 18U);
}

TEST(TraversabilityConfig, DefaultsAndPresetsAreUsableAt25Millimetres) {
    EXPECT_FALSE(TraversabilityConfig{}.problem(0.025));
    for (const char* name : kPresetNames) {
        const auto config = preset(name);
        ASSERT_TRUE(config) << name;
        described(*config);
        EXPECT_FALSE(config->problem(0.025)) << name;
        EXPECT_EQ(config->combine,
                  std::string(name) == "ethz" ? Combine::mean_nan : Combine::zero_dominates);
    }
    EXPECT_FALSE(preset("rex"));
    EXPECT_FALSE(preset(""));
}

TEST(TraversabilityConfig, PresetsHaveTheirPublishedValues) {
    const auto rex = described(*preset("rex_zed"));
    EXPECT_EQ(rex.at("traversability.normals.radius_m"), 0.075);
    EXPECT_EQ(rex.at("traversability.step.critical_cells"), 30.0);
    EXPECT_EQ(rex.at("traversability.roughness.critical_m"), 0.075);
    EXPECT_EQ(rex.at("traversability.roughness.radius_m"), 0.05);
    EXPECT_EQ(rex.at("traversability.weights.step"), 1.0);
    const auto laser = described(*preset("laser"));
    EXPECT_EQ(laser.at("traversability.step.first_radius_m"), 0.075);
    EXPECT_EQ(laser.at("traversability.step.second_radius_m"), 0.10);
    EXPECT_EQ(laser.at("traversability.roughness.critical_m"), 1.0);
    EXPECT_EQ(described(*preset("rex_demo_stairs")).at("traversability.slope.critical_rad"), 1.56);
    EXPECT_EQ(described(*preset("ethz")).at("traversability.step.first_radius_m"), 0.04);
}

TEST(TraversabilityConfig, RadiusBelowACellIsNamedAndCanBeWidened) {
    TraversabilityConfig config;
    const auto problem = config.problem(0.1);
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->find("traversability.normals.radius_m: 0.08 m"), std::string::npos)
        << *problem;
    const TraversabilityConfig widened = config.widened_to(0.1);
    EXPECT_FALSE(widened.problem(0.1));
    EXPECT_DOUBLE_EQ(widened.normals.radius_m, 0.1);
    EXPECT_DOUBLE_EQ(widened.step.second_radius_m, 0.1);
    EXPECT_DOUBLE_EQ(config.widened_to(0.025).normals.radius_m, 0.08) << "enough already";
}

TEST(TraversabilityConfig, SumNeedsAWeight) {
    TraversabilityConfig config;
    config.weights = {0.0, 0.0, 0.0};
    EXPECT_TRUE(config.problem(0.025));
}

}  // namespace
}  // namespace surefoot::traversability
