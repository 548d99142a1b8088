// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <latch>
#include <thread>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/stereo/census_window.hpp"
#include "surefoot/stereo/semi_global_level.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

/// Smooth blobs and noise, shifted by a changing disparity, with ties, jumps and borders. The right
/// half of the left image has the disparity `far_right`.
std::pair<GreyImage, GreyImage> pair_of(int width,
                                        int height,
                                        std::uint64_t seed,
                                        int far_right = 9) {
    Rng rng(seed);
    GreyImage left(width, height);
    GreyImage right(width, height);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u)
            right.at(u, v) =
                static_cast<std::uint8_t>(rng.uniform() < 0.2 ? 128 : rng.uniform(0.0, 256.0));
        for (int u = 0; u < width; ++u) {
            const int disparity = u > width / 2 ? far_right : 3 + v % 4;
            left.at(u, v) = right.at(std::max(u - disparity, 0), v);
        }
    }
    return {left, right};
}

constexpr struct {
    int width, height, disparities;
    int far_right = 9;
} kCases[] = {{1, 1, 1},
              {5, 3, 2},
              {64, 64, 16},
              {65, 70, 64},
              {70, 68, 21},
              {150, 40, 96},
              {40, 130, 256},
              {130, 330, 16},
              // With levels of smaller size, whose ranges are narrow and far apart.
              {400, 70, 40},
              {431, 66, 37, 30},
              {471, 129, 64, 40},
              {430, 130, 96, 70},
              {830, 66, 96, 70}};

TEST(SemiGlobal, FastIsPlainOnEveryProcessor) {
    for (const auto& c : kCases) {
        const auto [left, right] = pair_of(c.width, c.height, 7, c.far_right);
        SemiGlobalConfig config;
        config.disparities = c.disparities;
        Winners plain;
        search_plainly(config, left.view(), right.view(), plain);
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Winners fast;
            Serial serial;
            SemiGlobalSearch search(config);
            for (int repeat = 0; repeat < 2; ++repeat) {
                search.search(left.view(), right.view(), serial, fast);
                EXPECT_TRUE(plain == fast) << c.width << " x " << c.height << ", " << c.disparities
                                           << " on " << hwy::TargetName(target);
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

TEST(SemiGlobal, EveryPenaltyMeansTheSame) {
    const auto [left, right] = pair_of(70, 20, 3);
    for (const int contrast_shift : {0, 1, 3, 8}) {
        SemiGlobalConfig config;
        config.disparities = 32;
        config.slope_penalty = 3;
        config.jump_penalty = 50;
        config.min_jump_penalty = 20;
        config.contrast_shift = contrast_shift;
        Winners plain;
        Winners fast;
        Serial serial;
        search_plainly(config, left.view(), right.view(), plain);
        SemiGlobalSearch(config).search(left.view(), right.view(), serial, fast);
        EXPECT_TRUE(plain == fast) << contrast_shift;
    }
}

TEST(SemiGlobal, SameBytesForEveryExecutorAndAfterAnotherSize) {
    const auto [left, right] = pair_of(830, 140, 5, 40);
    const auto [small_left, small_right] = pair_of(90, 70, 6);
    const auto [other_left, other_right] = pair_of(430, 200, 8, 30);
    const SemiGlobalConfig config;
    Serial serial;
    Winners expected;
    SemiGlobalSearch(config).search(left.view(), right.view(), serial, expected);
    SemiGlobalSearch search(config);
    Backwards backwards;
    Threads two(2);
    for (Executor* executor : {static_cast<Executor*>(&backwards), static_cast<Executor*>(&two)}) {
        Winners found;
        search.search(small_left.view(), small_right.view(), *executor, found);
        search.search(other_left.view(), other_right.view(), *executor, found);
        search.search(left.view(), right.view(), *executor, found);
        EXPECT_TRUE(found == expected);
    }
}

/// An executor with one thread per task; no task begins before all threads are ready.
class Together final : public Executor {
  public:
    [[nodiscard]] int threads() const noexcept override { return 4; }
    void parallel_for(int count, const std::function<void(int)>& work) override {
        std::latch all_there(count);
        std::vector<std::thread> threads;
        threads.reserve(static_cast<std::size_t>(count));
        for (int index = 0; index < count; ++index) {
            threads.emplace_back([&, index] {
                all_there.arrive_and_wait();
                work(index);
            });
        }
        for (std::thread& thread : threads) thread.join();
    }
};

TEST(SemiGlobal, StripsWaitForTheOneAbove) {
    const auto [left, right] = pair_of(430, 600, 7, 40);
    SemiGlobalSearch search{SemiGlobalConfig{}};
    Serial serial;
    Winners expected;
    search.search(left.view(), right.view(), serial, expected);
    Together together;
    for (int repeat = 0; repeat < 10; ++repeat) {
        Winners found;
        search.search(left.view(), right.view(), together, found);
        ASSERT_TRUE(found == expected) << repeat;
    }
}

TEST(SemiGlobal, FindsAConstantShift) {
    Rng rng(2);
    GreyImage right(128, 64);
    for (std::size_t i = 0; i < right.size(); ++i)
        right.data()[i] = static_cast<std::uint8_t>(rng.uniform(0.0, 256.0));
    GreyImage left(128, 64);
    constexpr int kShift = 13;
    for (int v = 0; v < 64; ++v) {
        for (int u = 0; u < 128; ++u) left.at(u, v) = right.at(std::max(u - kShift, 0), v);
    }
    Serial serial;
    Winners found;
    SemiGlobalSearch(SemiGlobalConfig{}).search(left.view(), right.view(), serial, found);
    for (int v = 0; v < 64; ++v) {
        for (int u = kShift + kCensusReach_u; u < 128 - kCensusReach_u; ++u)
            ASSERT_EQ(found.disparity.at(u, v), kShift) << u << ", " << v;
    }
}

TEST(SemiGlobal, ARangeHoldsTheTrueDisparityAndFewOthers) {
    constexpr int kShift = 40;
    Rng rng(9);
    GreyImage right(256, 128);
    for (std::size_t i = 0; i < right.size(); ++i)
        right.data()[i] = static_cast<std::uint8_t>(rng.uniform(0.0, 256.0));
    GreyImage left(256, 128);
    for (int v = 0; v < 128; ++v) {
        for (int u = 0; u < 256; ++u) left.at(u, v) = right.at(std::max(u - kShift, 0), v);
    }
    Serial serial;
    LevelSearch level;
    LevelPrior prior;
    level.search({}, left.view(), right.view(), nullptr, serial, nullptr, &prior);
    const DisparityRange hopeful = prior.hopeful(6, 1);
    EXPECT_GT(hopeful.begin, kShift - 8);
    EXPECT_LE(hopeful.begin, kShift);
    EXPECT_GT(hopeful.end, kShift);
    EXPECT_LT(hopeful.end, kShift + 8);
}

TEST(SemiGlobal, APathThatEntersARangeHasCostsOnlyWhereBothRangesMeet) {
    constexpr int kDisparities = 32;
    constexpr struct {
        DisparityRange before, range;
    } kMoves[] = {{{0, 8}, {16, 24}}, {{16, 24}, {0, 8}}, {{0, 16}, {8, 24}}, {{8, 24}, {0, 16}}};
    for (const auto& [before, range] : kMoves) {
        std::vector<std::uint8_t> state((kDisparities + 1) * kLanes, 7);
        kernels::enter_range(state.data(), before.begin, before.end, range.begin, range.end);
        for (int d = range.begin; d <= range.end; ++d) {
            const bool known = d < range.end && d >= before.begin && d < before.end;
            for (int lane = 0; lane < kLanes; ++lane)
                ASSERT_EQ(state[static_cast<std::size_t>(d * kLanes + lane)], known ? 7 : 255) << d;
        }
    }
}

TEST(Halve, IsTheRoundedMeanOfFourPixels) {
    GreyImage in(3, 3);
    const std::uint8_t values[] = {0, 1, 9, 2, 3, 9, 8, 8, 255};
    std::copy(std::begin(values), std::end(values), in.data());
    GreyImage out;
    halve(in.view(), out);
    ASSERT_EQ(out.width(), 2);
    ASSERT_EQ(out.height(), 2);
    EXPECT_EQ(out.at(0, 0), 2) << "6 / 4 = 1.5, rounded up";
    EXPECT_EQ(out.at(1, 0), 9) << "the last column repeats";
    EXPECT_EQ(out.at(0, 1), 8) << "the last row repeats";
    EXPECT_EQ(out.at(1, 1), 255);
    halve(GreyImage(1, 1, 77).view(), out);
    EXPECT_EQ(out.at(0, 0), 77);
}

TEST(SemiGlobalConfig, SaysWhatIsWrong) {
    EXPECT_FALSE(SemiGlobalConfig{}.problem());
    EXPECT_TRUE(SemiGlobalConfig{257}.problem());
    SemiGlobalConfig steep;
    steep.jump_penalty = 101;
    EXPECT_TRUE(steep.problem());
    steep.jump_penalty = 5;
    EXPECT_TRUE(steep.problem());
    SemiGlobalConfig no_byte;
    no_byte.slope_penalty = 256;
    EXPECT_TRUE(no_byte.problem());
}

}  // namespace
}  // namespace surefoot::stereo
