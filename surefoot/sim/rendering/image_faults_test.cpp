// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/image_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

constexpr int kFrames = 20'000;
constexpr int kHeight = 94;

int count(const std::vector<InjectedFault>& faults, ImageFault kind) {
    return static_cast<int>(std::count_if(
        faults.begin(), faults.end(), [&](const auto& fault) { return fault.kind == kind; }));
}

TEST(ImageFaultsTest, NoneByDefault) {
    EXPECT_TRUE(plan_faults({}, kFrames, kHeight, 1).empty());
    EXPECT_TRUE(plan_faults({}, 0, kHeight, 1).empty());
}

TEST(ImageFaultsTest, EachKindIsAsFrequentAsItsProbability) {
    ImageFaultConfig config;
    config.drop_probability = 0.05;
    config.repeat_probability = 0.1;
    config.tear_probability = 0.02;
    const auto faults = plan_faults(config, kFrames, kHeight, 1);
    const auto expect_share = [&](ImageFault kind, double share) {
        const double five_sigma = 5.0 * std::sqrt(kFrames * share * (1.0 - share));
        EXPECT_NEAR(count(faults, kind), kFrames * share, five_sigma)
            << kImageFaultNames[static_cast<int>(kind)];
    };
    expect_share(ImageFault::dropped, 0.05);
    expect_share(ImageFault::repeated, 0.1);
    expect_share(ImageFault::torn, 0.02);
    EXPECT_EQ(count(faults, ImageFault::frozen), 0);
    int lowest = kHeight;
    int highest = 0;
    for (std::size_t i = 0; i < faults.size(); ++i) {
        EXPECT_GE(faults[i].frame, i == 0 ? 1 : faults[i - 1].frame + 1);
        if (faults[i].kind != ImageFault::torn) continue;
        lowest = std::min(lowest, faults[i].tear_row);
        highest = std::max(highest, faults[i].tear_row);
    }
    EXPECT_GE(lowest, 1);  // never the whole image
    EXPECT_LT(highest, kHeight);
    EXPECT_GT(highest - lowest, kHeight - 15);
    EXPECT_EQ(faults, plan_faults(config, kFrames, kHeight, 1));
    EXPECT_NE(faults, plan_faults(config, kFrames, kHeight, 2));
}

TEST(ImageFaultsTest, AFreezeLastsAsLongAsConfigured) {
    ImageFaultConfig config;
    config.freeze_probability = 0.002;
    config.freeze_frames = 7;
    const auto faults = plan_faults(config, kFrames, kHeight, 3);
    ASSERT_GT(faults.size(), 70U);
    std::size_t run = 1;
    for (std::size_t i = 1; i < faults.size(); ++i, ++run) {
        if (faults[i].frame == faults[i - 1].frame + 1) continue;
        EXPECT_EQ(run % 7, 0U) << "freeze that ends at frame " << faults[i - 1].frame;
        run = 0;
    }
}

TEST(ImageFaultsTest, PlannedFaultsReplaceDrawnOnes) {
    ImageFaultConfig config;
    config.drop_probability = 1.0;
    config.planned = {
        {3, ImageFault::torn, 20}, {5, ImageFault::torn, 0}, {4, ImageFault::frozen, 0}};
    const auto faults = plan_faults(config, 7, kHeight, 3);
    ASSERT_EQ(faults.size(), 6U);
    EXPECT_EQ(faults[0], (InjectedFault{1, ImageFault::dropped, 0}));
    EXPECT_EQ(faults[2], (InjectedFault{3, ImageFault::torn, 20}));
    EXPECT_EQ(faults[3], (InjectedFault{4, ImageFault::frozen, 0}));
    EXPECT_EQ(faults[4].kind, ImageFault::torn);
    EXPECT_GE(faults[4].tear_row, 1);
}

TEST(ImageFaultsTest, ImpossiblePlansGetASentence) {
    ImageFaultConfig config;
    config.planned = {{0, ImageFault::dropped, 0}};
    EXPECT_NE(config.problem(10, kHeight)->find("frame 0; give a frame from 1 to 9"),
              std::string::npos);
    config.planned = {{10, ImageFault::dropped, 0}};
    EXPECT_TRUE(config.problem(10, kHeight));
    config.planned = {{9, ImageFault::torn, 94}};
    EXPECT_NE(config.problem(10, kHeight)->find("row 94; give a row from 1 to 93"),
              std::string::npos);
    config.planned = {{9, ImageFault::torn, 93}};
    EXPECT_FALSE(config.problem(10, kHeight));
}

}  // namespace
}  // namespace surefoot::sim
