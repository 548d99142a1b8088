// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/suite_table.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "apps/surefoot/suite_report.hpp"
#include "io/file.hpp"

namespace surefoot::app {
namespace {

constexpr std::uint64_t kSettings = 7;

SuiteResult result_of(const std::string& scene, std::uint64_t seed, double noise, double figure) {
    return {{scene, seed, noise, 0}, std::vector<double>(suite_figures().size(), figure)};
}

class SuiteTableTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("surefoot-suite-" + std::to_string(::getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
        path_ = (folder_ / "cases.csv").string();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_;
    std::string path_;
};

TEST_F(SuiteTableTest, GoesOnWhereItStopped) {
    {
        auto table = SuiteTable::open(path_, kSettings);
        ASSERT_TRUE(table.ok());
        EXPECT_FALSE(table->holds({"floor", 3, 2.0, 0}));
        ASSERT_TRUE(table->add(result_of("floor", 3, 2.0, 1.0 / 3.0)).ok());
        ASSERT_TRUE(table->add(result_of("table", 3, 2.0, std::nan(""))).ok());
    }
    const auto again = SuiteTable::open(path_, kSettings);
    ASSERT_TRUE(again.ok()) << again.error().message;
    ASSERT_EQ(again->results().size(), 2U);
    EXPECT_TRUE(again->holds({"floor", 3, 2.0, 0}));
    for (const SuiteCase& other : {SuiteCase{"floor", 4, 2.0, 0},
                                   SuiteCase{"floor", 3, 1.0, 0},
                                   SuiteCase{"floor", 3, 2.0, 40},
                                   SuiteCase{"stairs", 3, 2.0, 0}})
        EXPECT_FALSE(again->holds(other)) << other.name();
    EXPECT_EQ(again->results()[0].figures[2], 1.0 / 3.0);
    EXPECT_TRUE(std::isnan(again->results()[1].figures[2]));
}

TEST_F(SuiteTableTest, ALineThatWasCutOffIsMeasuredAgain) {
    auto table = SuiteTable::open(path_, kSettings);
    ASSERT_TRUE(table->add(result_of("floor", 1, 1.0, 0.5)).ok());
    ASSERT_TRUE(table->add(result_of("floor", 2, 1.0, 0.5)).ok());
    std::string text = *io::read_file(path_);
    for (const std::size_t cut : {std::size_t{1}, std::size_t{5}, std::size_t{40}}) {
        std::ofstream(path_) << text.substr(0, text.size() - cut);
        const auto again = SuiteTable::open(path_, kSettings);
        ASSERT_TRUE(again.ok());
        EXPECT_EQ(again->results().size(), 1U) << cut << " bytes cut off";
    }
}

TEST_F(SuiteTableTest, OtherSettingsAreNotMixed) {
    auto table = SuiteTable::open(path_, kSettings);
    ASSERT_TRUE(table->add(result_of("floor", 1, 1.0, 0.5)).ok());
    const auto other = SuiteTable::open(path_, kSettings + 1);
    ASSERT_FALSE(other.ok());
    EXPECT_EQ(other.error().code, ErrorCode::usage);
    EXPECT_NE(other.error().message.find(path_), std::string::npos);
}

TEST(SuiteReport, SummarisesBySceneAndNoise) {
    std::vector<SuiteResult> results;
    for (const double noise : {1.0, 2.0}) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed)
            results.push_back(result_of("floor", seed, noise, noise * static_cast<double>(seed)));
    }
    results.push_back(result_of("table", 1, 1.0, std::nan("")));
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
    EXPECT_NE(suite_html(results).find("floor/seed 2/noise 2"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::app
