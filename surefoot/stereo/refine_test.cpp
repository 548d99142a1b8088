// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stereo/test_executors.hpp"
#include "surefoot/stereo/test_scene.hpp"
#include "surefoot/stereo/test_targets.hpp"

namespace surefoot::stereo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const test::SyntheticPair& plane() {
    static const test::SyntheticPair pair = [] {
        test::SceneConfig config;
        config.width = 400;
        config.height = 240;
        config.focal_px = 220.0;
        config.contrast_grey = 6.0;
        return test::Scene(config).render();
    }();
    return pair;
}

struct Refined {
    Image<float> disparity_px;
    Image<float> residual_grey;
    Image<float> gradient_grey_px;
    Image<float> shift_px;
};

Refined refine(const GreyImage& left,
               const GreyImage& right,
               Image<float> start,
               Executor& executor) {
    const int width = left.width();
    const Image<float> empty(width, left.height());
    Refined result{std::move(start), empty, empty, empty};
    SubpixelRefiner refiner{RefineConfig{}};
    const Image<std::uint8_t> far_from_jumps(width, left.height(), 255);
    refiner.refine(left.view(),
                   right.view(),
                   result.disparity_px,
                   Filter::none,
                   far_from_jumps,
                   executor,
                   result.disparity_px,
                   [&](int v, const RefinedRow& row) {
                       std::copy_n(row.residual_grey, width, result.residual_grey.row(v));
                       std::copy_n(row.gradient_grey_px, width, result.gradient_grey_px.row(v));
                       std::copy_n(row.shift_px, width, result.shift_px.row(v));
                   });
    return result;
}

struct Errors {
    double mean_px = 0.0;
    double rms_px = 0.0;
};

/// Away from the border, where windows are whole.
Errors errors_of(const Image<float>& disparity_px, const Image<float>& truth_px) {
    constexpr int kMargin_px = 20;
    double sum = 0.0;
    double sum_sq = 0.0;
    int count = 0;
    for (int v = kMargin_px; v < truth_px.height() - kMargin_px; ++v) {
        for (int u = kMargin_px; u < truth_px.width() - kMargin_px; ++u) {
            const double error = static_cast<double>(disparity_px.at(u, v) - truth_px.at(u, v));
            if (std::isnan(error)) continue;
            sum += error;
            sum_sq += error * error;
            ++count;
        }
    }
    return {sum / count, std::sqrt(sum_sq / count)};
}

std::vector<float> smoothed(const std::vector<float>& row) {
    constexpr int kRadius = 4;
    std::vector<float> padded(row.size() + 2 * kRadius, kNan);
    std::copy(row.begin(), row.end(), padded.begin() + kRadius);
    std::vector<float> out(row.size());
    smooth_along(padded.data() + kRadius, static_cast<int>(row.size()), kRadius, 1.5, out.data());
    return out;
}

TEST(SmoothAlong, KeepsASlantedPlane) {
    std::vector<float> row(20);
    for (std::size_t u = 0; u < row.size(); ++u) row[u] = 10.0F + 0.25F * static_cast<float>(u);
    EXPECT_EQ(smoothed(row), row);  // quarters are exact
}

TEST(SmoothAlong, DoesNotMixSurfacesAndKeepsTheUnknownUnknown) {
    std::vector<float> row(12, 5.0F);
    std::fill(row.begin() + 6, row.end(), 9.0F);
    row[3] = kNan;
    const std::vector<float> out = smoothed(row);
    for (std::size_t u = 0; u < row.size(); ++u) {
        if (u == 3) {
            EXPECT_TRUE(std::isnan(out[u]));
        } else {
            EXPECT_EQ(out[u], row[u]) << u;
        }
    }
}

TEST(SubpixelRefiner, RemovesALeanOfTheWholeSurface) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i) start.data()[i] += 0.15F;
    const Refined refined = refine(pair.left, pair.right, start, serial);
    const Errors errors = errors_of(refined.disparity_px, pair.disparity_px);
    std::printf(
        "from a lean of 0.150 px: mean %+.3f px, rms %.3f px\n", errors.mean_px, errors.rms_px);
    // The prior of 0.2 px holds back a part where texture is weak.
    EXPECT_LT(std::abs(errors.mean_px), 0.03);
    EXPECT_LT(errors.rms_px, 0.09);
}

TEST(SubpixelRefiner, RemovesThePreferenceForWholePixelsAndScatter) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    Rng rng(9);
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i) {
        const double d = static_cast<double>(start.data()[i]);
        start.data()[i] +=
            static_cast<float>(-0.12 * std::sin(2.0 * std::numbers::pi * d) + 0.15 * rng.normal());
    }
    const Errors before = errors_of(start, pair.disparity_px);
    const Refined refined = refine(pair.left, pair.right, start, serial);
    const Errors after = errors_of(refined.disparity_px, pair.disparity_px);
    std::printf(
        "whole-pixel preference and scatter: rms %.3f -> %.3f px\n", before.rms_px, after.rms_px);
    EXPECT_GT(before.rms_px, 0.16);
    EXPECT_LT(after.rms_px, 0.5 * before.rms_px);
}

TEST(SubpixelRefiner, BrightnessOfTheEyesDoesNotMatter) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    GreyImage brighter = pair.right;
    for (std::size_t i = 0; i < brighter.size(); ++i) {
        brighter.data()[i] = static_cast<std::uint8_t>(std::min(255, brighter.data()[i] + 20));
    }
    const Refined same = refine(pair.left, pair.right, pair.disparity_px, serial);
    const Refined bright = refine(pair.left, brighter, pair.disparity_px, serial);
    const Errors difference = errors_of(bright.disparity_px, same.disparity_px);
    // Grey differences are cut at 32 levels: 20 more let a few true differences reach the cut.
    EXPECT_LT(difference.rms_px, 0.02);
}

TEST(SubpixelRefiner, WithoutTextureNothingMoves) {
    Serial serial;
    const GreyImage grey(60, 50, 90);
    const Image<float> start(60, 50, 10.5F);
    const Refined refined = refine(grey, grey, start, serial);
    EXPECT_EQ(refined.disparity_px, start);
    EXPECT_EQ(refined.gradient_grey_px.at(40, 25), 0.0F);
}

TEST(SubpixelRefiner, UnknownStaysUnknownEvenInTinyImages) {
    Serial serial;
    for (const int side : {1, 2, 7}) {
        const GreyImage grey(side, side, 90);
        const Refined refined = refine(grey, grey, Image<float>(side, side, kNan), serial);
        EXPECT_TRUE(std::isnan(refined.disparity_px.at(0, 0)));
        EXPECT_TRUE(std::isnan(refined.shift_px.at(0, 0)));
    }
}

TEST(SubpixelRefiner, SameBytesOnEveryProcessor) {
    Serial serial;
    const test::SyntheticPair& pair = plane();
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i)
        start.data()[i] = std::isnan(start.data()[i]) ? 0.5F : start.data()[i];
    const Refined expected = refine(pair.left, pair.right, start, serial);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        const Refined found = refine(pair.left, pair.right, start, serial);
        EXPECT_EQ(found.disparity_px, expected.disparity_px) << hwy::TargetName(target);
        EXPECT_EQ(found.residual_grey, expected.residual_grey);
        EXPECT_EQ(found.gradient_grey_px, expected.gradient_grey_px);
    }
    hwy::SetSupportedTargetsForTest(0);
}

TEST(SubpixelRefiner, SameBytesForEveryExecutor) {
    Serial serial;
    test::Backwards backwards;
    test::TwoThreads two;
    const test::SyntheticPair& pair = plane();
    Image<float> start = pair.disparity_px;
    for (std::size_t i = 0; i < start.size(); ++i)
        start.data()[i] = std::isnan(start.data()[i]) ? 0.5F : start.data()[i];
    const Refined a = refine(pair.left, pair.right, start, serial);
    const Refined b = refine(pair.left, pair.right, start, backwards);
    const Refined c = refine(pair.left, pair.right, start, two);
    EXPECT_EQ(a.disparity_px, b.disparity_px);
    EXPECT_EQ(a.disparity_px, c.disparity_px);
    EXPECT_EQ(a.residual_grey, c.residual_grey);
}

}  // namespace
}  // namespace surefoot::stereo
