// SPDX-License-Identifier: Apache-2.0
#include "service/page/recording_desk.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace surefoot::page {
namespace {

RecordingState at(RecordingStage stage) {
    RecordingState state;
    state.stage = stage;
    return state;
}

TEST(RecordingDesk, NobodyIsAskedWhereNothingCanBeRecorded) {
    RecordingDesk desk;
    std::vector<bool> asked;
    EXPECT_FALSE(desk.ask({true}));
    desk.serve_with([&](const RecordWish& wish) { asked.push_back(wish.on); });
    EXPECT_FALSE(desk.ask({true}));
    desk.tell(at(RecordingStage::ready));
    EXPECT_TRUE(desk.ask({true}));
    EXPECT_TRUE(desk.ask({false}));
    EXPECT_EQ(asked, (std::vector<bool>{true, false}));
    desk.serve_with({});
    EXPECT_FALSE(desk.ask({true})) << "who recorded is gone";
}

TEST(RecordingDesk, OnlyNewsHasANewSerial) {
    RecordingDesk desk;
    const std::uint64_t first = desk.serial();
    desk.tell(at(RecordingStage::off));
    EXPECT_EQ(desk.serial(), first);
    desk.tell(at(RecordingStage::recording));
    EXPECT_GT(desk.serial(), first);
    EXPECT_EQ(desk.state().stage, RecordingStage::recording);
}

}  // namespace
}  // namespace surefoot::page
