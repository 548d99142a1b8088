// SPDX-License-Identifier: Apache-2.0
// Tests which lens model explains the boards.
#include "surefoot/calibration/lenses/lens_advice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "surefoot/calibration/boards/wide_boards_testing.hpp"
#include "surefoot/calibration/mono_calibration.hpp"
#include "surefoot/calibration/synthetic_views_testing.hpp"

namespace surefoot::calibration {
namespace {

using testing::WideProfile;

constexpr double kNoise_px = 0.05;
constexpr ImageSize kSize{640, 480};
const Board kBoard{.columns = 8, .rows = 5, .spacing_m = 0.03};

camera::Camera usual_camera() {
    return {camera::PinholeRadTan{480.0, 480.8, 325.0, 236.0, -0.28, 0.11, 4e-4, -2e-4, -0.02},
            kSize.width,
            kSize.height};
}

/// Whole boards at twelve positions, through a wide lens, with noise.
std::vector<BoardView> views_of(const camera::Camera& camera, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<BoardView> views;
    for (int i = 0; i < 12; ++i) {
        const Pose T = testing::wide_pose(kBoard, camera, 40.0, 7.0, rng);
        views.push_back(testing::view_of(kBoard, camera, T, kNoise_px, rng));
    }
    return views;
}

TEST(LensAdvice, NamesTheFisheyeWhereAPinholeCameraWasChosen) {
    for (const auto& camera : {testing::wide_camera(WideProfile::equidistant, 120.0, kSize),
                               testing::wide_camera(WideProfile::bought, 140.0, kSize),
                               testing::wide_camera(WideProfile::equisolid, 170.0, kSize)}) {
        const auto views = views_of(camera, 31);
        for (const LensKind chosen : {LensKind::pinhole4, LensKind::pinhole5}) {
            const auto advice = advise_lens(kBoard, views, kSize, chosen);
            ASSERT_TRUE(advice);
            EXPECT_EQ(advice->better.kind, LensKind::fisheye);
            EXPECT_LT(advice->better.rms_px, 2.0 * kNoise_px);
            EXPECT_NE(in_words(*advice).find("looks like a fisheye (rms"), std::string::npos);
            EXPECT_NE(in_words(*advice).find("try --model fisheye"), std::string::npos);
        }
        EXPECT_FALSE(advise_lens(kBoard, views, kSize, LensKind::fisheye));
    }
}

TEST(LensAdvice, NamesAnotherLensWhereAFisheyeWasChosen) {
    const auto rational = views_of(testing::wide_camera(WideProfile::rational, 120.0, kSize), 32);
    const auto advice = advise_lens(kBoard, rational, kSize, LensKind::fisheye);
    ASSERT_TRUE(advice);
    EXPECT_EQ(advice->better.kind, LensKind::rational);
    EXPECT_FALSE(advise_lens(kBoard, rational, kSize, LensKind::rational));
}

/// Regression: from a pinhole start alone, seeds 37 and 42 ended at a focal length of 1.5 px.
TEST(LensAdvice, ARationalLensOf120DegreesExplainsItself) {
    const auto camera = testing::wide_camera(WideProfile::rational, 120.0, kSize);
    for (std::uint64_t seed = 36; seed <= 43; ++seed) {
        const auto views = views_of(camera, seed);
        const auto result = calibrate_mono(kBoard, views, kSize, LensKind::rational);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        EXPECT_LT(result->rms_px, 2.0 * kNoise_px) << "seed " << seed;
    }
}

TEST(LensAdvice, SaysNothingWhereTheChosenLensExplainsTheBoards) {
    const auto views = views_of(usual_camera(), 34);
    for (const LensKind chosen : {LensKind::pinhole5, LensKind::rational})
        EXPECT_FALSE(advise_lens(kBoard, views, kSize, chosen));
    EXPECT_FALSE(advise_lens(kBoard, {}, kSize, LensKind::pinhole5));
    const std::vector<BoardView> empty(5);
    EXPECT_FALSE(advise_lens(kBoard, empty, kSize, LensKind::pinhole5));
}

TEST(LensAdvice, ALensThatShowsNothingIsSaidSo) {
    const LensAdvice advice{{LensKind::pinhole4, std::numeric_limits<double>::infinity()},
                            {LensKind::fisheye, 0.2}};
    EXPECT_NE(in_words(advice).find("pinhole4 does not fit most views"), std::string::npos);
}

TEST(LensAdvice, IsTheReasonInsteadOfTilt) {
    // For a fisheye of 170 deg a pinhole camera has no estimate, or a useless one.
    const auto views = views_of(testing::wide_camera(WideProfile::equidistant, 170.0, kSize), 35);
    const auto result = calibrate_mono(kBoard, views, kSize, LensKind::pinhole4);
    if (result) {
        EXPECT_TRUE(advise_lens(kBoard, views, kSize, LensKind::pinhole4));
    } else {
        EXPECT_NE(result.error().message.find("try --model fisheye"), std::string::npos)
            << result.error().message;
        EXPECT_EQ(result.error().message.find("tilt"), std::string::npos);
    }
}

}  // namespace
}  // namespace surefoot::calibration
