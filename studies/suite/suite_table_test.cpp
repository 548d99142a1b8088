// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_table.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "studies/suite/suite_report.hpp"
#include "studies/suite/suite_rows.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

constexpr std::uint64_t kConditions = 7;

SuiteBin bin_of(double from, double error_m) {
    SuiteBin bin{BinKey::range, from, from + 0.5, {}};
    bin.errors.add(error_m);
    bin.errors.add(2.0 * error_m);
    return bin;
}

SuiteResult result_of(const std::string& scene, std::uint64_t seed, double noise, double figure) {
    SuiteResult result;
    result.which = {scene, seed, noise, 0, 4.0, "rex"};
    result.figures = std::vector<double>(suite_figures().size(), figure);
    result.bins = {bin_of(0.5, 0.01 * noise), bin_of(1.0, 0.02)};
    result.steps = {
        {1, 1.5, 9, true, true, true, "", "OK", ""},
        {2, 11.5, 17, false, false, false, "drop_off|tilt", "NOT_TRAVERSABLE", "DROP_OFF"}};
    result.tallies.add({TallyKey::reason, "UNKNOWN_CELLS", 7, 4});
    result.tallies.add({TallyKey::danger, "drop_off", 1, 1});
    return result;
}

class SuiteTableTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = (std::filesystem::temp_directory_path() /
                   ("surefoot-suite-" + std::to_string(::getpid()) + "-" +
                    testing::UnitTest::GetInstance()->current_test_info()->name()))
                      .string();
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::string text_of(const std::string& file) const {
        return *io::read_file(folder_ + "/" + file);
    }
    void cut(const std::string& file, std::size_t bytes) const {
        const std::string text = text_of(file);
        std::ofstream(folder_ + "/" + file) << text.substr(0, text.size() - bytes);
    }

    std::string folder_;
};

TEST_F(SuiteTableTest, GoesOnWhereItStopped) {
    const SuiteResult first = result_of("floor", 3, 2.0, 1.0 / 3.0);
    {
        auto table = SuiteTable::open(folder_, kConditions);
        ASSERT_TRUE(table.ok()) << table.error().message;
        EXPECT_FALSE(table->holds(first.which));
        ASSERT_TRUE(table->add(first).ok());
        ASSERT_TRUE(table->add(result_of("table", 3, 2.0, std::nan(""))).ok());
    }
    auto again = SuiteTable::open(folder_, kConditions);
    ASSERT_TRUE(again.ok()) << again.error().message;
    ASSERT_EQ(again->results().size(), 2U);
    EXPECT_TRUE(again->holds(first.which));
    for (const SuiteCase& other : {SuiteCase{"floor", 4, 2.0, 0},
                                   SuiteCase{"floor", 3, 1.0, 0},
                                   SuiteCase{"floor", 3, 2.0, 40},
                                   SuiteCase{"stairs", 3, 2.0, 0}})
        EXPECT_FALSE(again->holds(other)) << other.name();
    const SuiteResult& read = again->results()[0];
    EXPECT_EQ(read.which, first.which);
    EXPECT_EQ(read.figures, first.figures);
    EXPECT_EQ(read.bins, first.bins);
    EXPECT_EQ(read.steps, first.steps);
    EXPECT_EQ(read.tallies.all(), first.tallies.all());
    EXPECT_TRUE(std::isnan(again->results()[1].figures[2]));
    // A third case is appended after the first two.
    ASSERT_TRUE(again->add(result_of("floor", 4, 2.0, 0.5)).ok());
    const auto third = SuiteTable::open(folder_, kConditions);
    ASSERT_EQ(third->results().size(), 3U);
    EXPECT_EQ(third->results()[2].bins.size(), 2U);
}

TEST_F(SuiteTableTest, WhatWasCutOffIsMeasuredAgainAndNothingIsDoubled) {
    const SuiteResult lost = result_of("floor", 2, 1.0, 0.25);
    for (const std::size_t bytes : {std::size_t{1}, std::size_t{5}, std::size_t{40}}) {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
        {
            auto table = SuiteTable::open(folder_, kConditions);
            ASSERT_TRUE(table->add(result_of("floor", 1, 1.0, 0.5)).ok());
            ASSERT_TRUE(table->add(lost).ok());
        }
        const std::string whole_bins = text_of("bins.csv");
        const std::string whole_steps = text_of("steps.csv");
        const std::string whole_verdicts = text_of("verdicts.csv");
        cut("cases.csv", bytes);
        auto again = SuiteTable::open(folder_, kConditions);
        ASSERT_TRUE(again.ok());
        ASSERT_EQ(again->results().size(), 1U) << bytes << " bytes cut off";
        EXPECT_EQ(again->results()[0].bins.size(), 2U);
        ASSERT_TRUE(again->add(lost).ok());
        EXPECT_EQ(text_of("bins.csv"), whole_bins);
        EXPECT_EQ(text_of("steps.csv"), whole_steps);
        EXPECT_EQ(text_of("verdicts.csv"), whole_verdicts);
    }
}

TEST_F(SuiteTableTest, HalfWrittenDetailsOfAnUnfinishedCaseAreDropped) {
    std::string one_case;
    {
        auto table = SuiteTable::open(folder_, kConditions);
        ASSERT_TRUE(table->add(result_of("floor", 1, 1.0, 0.5)).ok());
        one_case = text_of("bins.csv");
    }
    // The program was killed while it wrote the lines of the second case.
    std::ofstream(folder_ + "/bins.csv", std::ios::app) << "floor,2,1,0,range,0.5,1,2,0.0";
    const auto again = SuiteTable::open(folder_, kConditions);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(text_of("bins.csv"), one_case);
}

TEST_F(SuiteTableTest, OtherConditionsAreNotMixed) {
    {
        auto table = SuiteTable::open(folder_, kConditions);
        ASSERT_TRUE(table->add(result_of("floor", 1, 1.0, 0.5)).ok());
    }
    const auto other = SuiteTable::open(folder_, kConditions + 1);
    ASSERT_FALSE(other.ok());
    EXPECT_EQ(other.error().code, ErrorCode::usage);
    EXPECT_NE(other.error().message.find(folder_), std::string::npos);
}

TEST_F(SuiteTableTest, KeepsThePictureOfTheWorstCaseWhateverComesFirst) {
    for (const bool worst_first : {true, false}) {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
        auto table = SuiteTable::open(folder_, kConditions);
        SuiteResult good = result_of("my/floor.yaml#a", 1, 1.0, 0.1);
        SuiteResult bad = result_of("my/floor.yaml#a", 2, 1.0, 0.2);
        good.thumbnail = {'g'};
        bad.thumbnail = {'b'};
        ASSERT_TRUE(is_worse(bad, good) && !is_worse(good, bad) && !is_worse(bad, bad));
        ASSERT_TRUE(table->add(worst_first ? bad : good).ok());
        ASSERT_TRUE(table->add(worst_first ? good : bad).ok());
        EXPECT_EQ(*io::read_file(thumbnail_file(folder_, "my/floor.yaml#a")), "b");
    }
}

TEST(SuiteRows, SummariseBySceneNoiseAndMotionModel) {
    std::vector<SuiteResult> results;
    results.push_back(result_of("table", 1, 1.0, std::nan("")));
    for (const double noise : {2.0, 1.0}) {
        for (std::uint64_t seed = 3; seed >= 1; --seed)
            results.push_back(result_of("floor", seed, noise, noise * static_cast<double>(seed)));
    }
    results[0].which.motion_model = "hand";
    results = sorted(std::move(results));
    EXPECT_EQ(results[1].which.name(), "floor/rex/seed 2/noise 1");
    const auto rows = summarise(results);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[1].scene, "floor");
    EXPECT_EQ(rows[1].noise, 2.0);
    EXPECT_EQ(rows[1].cases, 3);
    for (std::size_t i = 0; i < suite_figures().size(); ++i) {
        EXPECT_EQ(rows[1].median[i], 4.0);
        EXPECT_EQ(rows[1].worst[i], suite_figures()[i].lower_is_better ? 6.0 : 2.0);
        EXPECT_TRUE(std::isnan(rows[2].worst[i]));
    }
    const auto motion_models = summarise_by_motion_model(results);
    ASSERT_EQ(motion_models.size(), 3U);
    EXPECT_EQ(motion_models[0].motion_model, "hand");
    EXPECT_EQ(motion_models[2].motion_model, "rex");
    EXPECT_EQ(motion_models[2].cases, 3);

    const auto levels = pooled_by_noise(results);
    ASSERT_EQ(levels.size(), 2U);
    EXPECT_EQ(levels[0].cases, 4);
    ASSERT_EQ(levels[1].bins.size(), 2U);
    EXPECT_EQ(levels[1].bins[0].errors.count(), 6);
    EXPECT_NEAR(levels[1].bins[0].errors.percentile(0.25), 0.02, 0.002);
    EXPECT_NE(suite_html(results, "nowhere").find("floor/rex/seed 2/noise 2"), std::string::npos);
}

TEST(SuiteBins, CountsReadBack) {
    eval::ErrorHistogram errors;
    EXPECT_EQ(parse_counts(format_counts(errors)), errors);
    errors.add(0.0);
    errors.add(0.01);
    errors.add(5.0);
    EXPECT_EQ(parse_counts(format_counts(errors)), errors);
    for (const char* wrong : {"1", "1:", ":1", "-1:2", "99:1", "3:0", "3:-1", "a:b"})
        EXPECT_EQ(parse_counts(wrong), std::nullopt) << wrong;
}

}  // namespace
}  // namespace surefoot::app
