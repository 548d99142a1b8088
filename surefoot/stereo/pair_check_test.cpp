// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/pair_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "surefoot/core/rng.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 160;

/// Blobs of about 4 px that never repeat; `shift` moves the scene right and down.
GreyImage blobs(double shift_u_px, double shift_v_px) {
    Rng rng(5);
    cv::Mat noise(kHeight + 80, kWidth + 80, CV_8UC1);
    for (int v = 0; v < noise.rows; ++v) {
        for (int u = 0; u < noise.cols; ++u)
            noise.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(rng.below(256));
    }
    cv::GaussianBlur(noise, noise, cv::Size(), 2.0);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, shift_u_px - 40, 0, 1, shift_v_px - 40);
    GreyImage image(kWidth, kHeight);
    cv::Mat out(kHeight, kWidth, CV_8UC1, image.data());
    cv::warpAffine(noise, out, move, out.size(), cv::INTER_CUBIC);
    return image;
}

PairCheck check(const GreyImage& left, const GreyImage& right) {
    return check_pair(left.view(), right.view(), {48, 8});
}

TEST(PairCheck, MeasuresRowsToAFractionOfAPixel) {
    for (const double rows_px : {0.0, 0.4, -1.25, 3.5}) {
        const PairCheck found = check(blobs(0, 0), blobs(-12.3, rows_px));
        ASSERT_TRUE(found.enough());
        // The median of many corners is more certain than one corner, whose noise remains in the
        // absolute value.
        EXPECT_NEAR(found.row_offset_px, rows_px, 0.05);
        EXPECT_NEAR(found.row_error_px, std::abs(rows_px), 0.1);
        EXPECT_FALSE(found.swapped());
    }
}

TEST(PairCheck, NoticesExchangedEyes) {
    const PairCheck found = check(blobs(-12.3, 0), blobs(0, 0));
    ASSERT_TRUE(found.enough());
    EXPECT_TRUE(found.swapped());
    // Far objects have no disparity, which is no reason for a warning.
    EXPECT_FALSE(check(blobs(0, 0), blobs(0, 0)).swapped());
}

TEST(PairCheck, KnowsWhenItCannotTell) {
    // Rows farther apart than the search range, images of different scenes, empty images, tiny
    // images.
    EXPECT_FALSE(check(blobs(0, 0), blobs(-12, 20)).enough());
    GreyImage mirrored = blobs(0, 0);
    for (int v = 0; v < kHeight; ++v) std::reverse(mirrored.row(v), mirrored.row(v) + kWidth);
    EXPECT_FALSE(check(blobs(0, 0), mirrored).enough());
    const GreyImage black(kWidth, kHeight, 0);
    EXPECT_EQ(check(black, black).corners, 0);
    EXPECT_FALSE(check(blobs(0, 0), black).enough());
    for (const int side : {1, 2, 15, 17}) {
        const GreyImage tiny(side, side, 9);
        EXPECT_EQ(check(tiny, tiny).matched, 0);
    }
}

TEST(PairCheck, ARepeatingPatternIsNoEvidence) {
    GreyImage left(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) left.at(u, v) = (u / 8 + v / 8) % 2 == 0 ? 40 : 200;
    }
    EXPECT_FALSE(check(left, left).enough());
}

}  // namespace
}  // namespace surefoot::stereo
