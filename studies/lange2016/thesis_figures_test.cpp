// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::app {
namespace {

class ThesisFiguresTest : public ::testing::Test {
  protected:
    void SetUp() override {
        figures_.set("riser_m", 0.18);
        figures_.set("going_m", std::nan(""));
        figures_.set("risers", 3);
    }
    io::testing::TemporaryFolder folder_;
    ThesisFigures figures_;
};

TEST_F(ThesisFiguresTest, AFinishedPartIsReadBack) {
    ASSERT_TRUE(write_figures(folder_.path(), 7, figures_).ok());
    const auto read = read_figures(folder_.path(), 7);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_TRUE(*read);
    EXPECT_EQ((*read)->get("riser_m"), 0.18);
    EXPECT_TRUE(std::isnan((*read)->get("going_m")));
    EXPECT_EQ((*read)->get("risers"), 3.0);
    EXPECT_TRUE(std::isnan((*read)->get("width_m"))) << "was never set";
    EXPECT_EQ((*read)->all().size(), 3U);
}

TEST_F(ThesisFiguresTest, WhatWasDoneUnderOtherConditionsIsDoneAgain) {
    EXPECT_FALSE(*read_figures(folder_.path(), 7)) << "nothing is there";
    ASSERT_TRUE(write_figures(folder_.path(), 7, figures_).ok());
    EXPECT_FALSE(*read_figures(folder_.path(), 8));
}

TEST_F(ThesisFiguresTest, ADamagedFileIsNamedWithItsLine) {
    for (const char* text :
         {"",
          "riser_m,0.18\n",
          "# surefoot thesis figures 1 0000000000000007\nname,value\nriser",
          "# surefoot thesis figures 1 0000000000000007\nname,value\nriser_m,0.1x\n"}) {
        ASSERT_TRUE(io::write_file(folder_ / "figures.csv", text).ok());
        const auto read = read_figures(folder_.path(), 7);
        ASSERT_FALSE(read) << text;
        EXPECT_NE(read.error().message.find("figures.csv: '"), std::string::npos);
    }
}

}  // namespace
}  // namespace surefoot::app
