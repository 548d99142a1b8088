// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/consistency.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/stereo_targets_testing.hpp"

namespace surefoot::stereo {
namespace {

Image<float> row_image(const std::vector<float>& values) {
    Image<float> image(static_cast<int>(values.size()), 1);
    std::copy(values.begin(), values.end(), image.data());
    return image;
}

std::vector<int> known_columns(const Image<float>& image) {
    std::vector<int> known;
    for (int u = 0; u < image.width(); ++u) {
        if (!std::isnan(image.at(u, 0))) known.push_back(u);
    }
    return known;
}

TEST(DropHidden, NothingKnownStaysNothing) {
    Serial serial;
    Image<float> empty;
    drop_hidden(serial, 1.0, empty);
    Image<float> unknown = row_image({kNanF, kNanF});
    drop_hidden(serial, 1.0, unknown);
    EXPECT_TRUE(known_columns(unknown).empty());
}

TEST(DropHidden, ABackgroundPixelBehindANearerOneGoes) {
    Serial serial;
    // Column 6 with disparity 4 and column 4 with disparity 2 both claim right column 2.
    Image<float> image = row_image({kNanF, kNanF, kNanF, 2, 2, 2, 4, 4});
    drop_hidden(serial, 1.0, image);
    EXPECT_EQ(known_columns(image), (std::vector<int>{3, 6, 7}));
}

TEST(DropHidden, ASlantedSurfaceStays) {
    Serial serial;
    Image<float> image = row_image({kNanF, kNanF, kNanF, 2.0F, 2.6F, 3.2F, 3.8F, 4.4F});
    drop_hidden(serial, 1.0, image);
    EXPECT_EQ(known_columns(image), (std::vector<int>{3, 4, 5, 6, 7}));
}

TEST(DropHidden, MatchesOutsideTheRightImageGo) {
    Serial serial;
    Image<float> image = row_image({1.0F, 0.4F, 3.0F, 3.0F});
    drop_hidden(serial, 1.0, image);
    EXPECT_EQ(known_columns(image), (std::vector<int>{1, 3}));
}

Image<std::uint8_t> jumps_of(const Image<float>& disparity_px) {
    Serial serial;
    Image<std::uint8_t> jumps;
    mark_jumps(serial, disparity_px, 1.0, jumps);
    return jumps;
}

TEST(MarkJumps, BothSidesOfAStepAndAcrossAHole) {
    Image<std::uint8_t> jumps = jumps_of(row_image({5, 5, 5, 9, 9, 9}));
    EXPECT_EQ(jumps.at(2, 0), 255);
    EXPECT_EQ(jumps.at(3, 0), 255);
    EXPECT_EQ(jumps.at(0, 0), 0);
    jumps = jumps_of(row_image({5, 5, kNanF, kNanF, 9, 9}));
    EXPECT_EQ(jumps.at(1, 0), 255);
    EXPECT_EQ(jumps.at(4, 0), 255);
}

TEST(MarkJumps, ARampThatNoGroundHasIsAJump) {
    std::vector<float> ramp;
    for (int u = 0; u < 20; ++u)
        ramp.push_back(10.0F + 0.9F * static_cast<float>(std::clamp(u - 6, 0, 8)));
    const Image<std::uint8_t> jumps = jumps_of(row_image(ramp));
    EXPECT_EQ(jumps.at(10, 0), 255);
    EXPECT_EQ(jumps.at(2, 0), 0);
    EXPECT_EQ(jumps.at(18, 0), 0);
}

TEST(MarkJumps, GroundAtAUsableAngleIsNone) {
    // 0.3 px per pixel: a camera 0.35 m above the floor with a baseline of 0.12 m.
    Image<float> floor(30, 30);
    for (int v = 0; v < 30; ++v) {
        for (int u = 0; u < 30; ++u) floor.at(u, v) = 3.0F + 0.3F * static_cast<float>(v);
    }
    floor.at(10, 10) = kNanF;
    const Image<std::uint8_t> jumps = jumps_of(floor);
    for (std::size_t i = 0; i < jumps.size(); ++i) EXPECT_EQ(jumps.data()[i], 0) << "pixel " << i;
}

/// The rule of mark_jumps along one line of pixels, `stride` elements apart, implemented literally.
void mark_line(const float* d, std::uint8_t* jump, int count, int stride) {
    int last = -1;  // the last known pixel
    for (int i = 0; i < count; ++i) {
        const float here = d[i * stride];
        if (std::isnan(here)) continue;
        const auto differs = [&](int from) {
            return std::abs(here - d[from * stride]) > 1.0F + 0.4F * static_cast<float>(i - from);
        };
        if (last >= 0 && differs(last)) jump[last * stride] = jump[i * stride] = 255;
        if (i >= 4 && differs(i - 4)) jump[(i - 2) * stride] = 255;
        last = i;
    }
}

TEST(MarkJumps, FollowsTheRuleOnEveryProcessorAndThread) {
    Rng rng(8);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {2, 5}, {3, 2}, {5, 4}, {71, 40}, {300, 70}}) {
        Image<float> in(width, height);
        float surface_px = 20.0F;
        for (std::size_t i = 0; i < in.size(); ++i) {
            if (rng.uniform() < 0.1) surface_px = static_cast<float>(rng.uniform(15.0, 25.0));
            surface_px += static_cast<float>(rng.uniform(-0.5, 0.5));
            in.data()[i] = rng.uniform() < 0.3 ? kNanF : surface_px;
        }
        Image<std::uint8_t> expected(width, height, 0);
        for (int v = 0; v < height; ++v) mark_line(in.row(v), expected.row(v), width, 1);
        for (int u = 0; u < width; ++u)
            mark_line(in.data() + u, expected.data() + u, height, width);
        Threads threads(2);
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            EXPECT_EQ(jumps_of(in), expected) << hwy::TargetName(target) << " " << width;
            Image<std::uint8_t> jumps;
            mark_jumps(threads, in, 1.0, jumps);
            EXPECT_EQ(jumps, expected) << hwy::TargetName(target) << " " << width;
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

/// Chessboard distance from the nearest mark, 255 beyond kFarthest_px.
std::uint8_t distance_plainly(const Image<std::uint8_t>& marks, int u, int v) {
    int nearest = kFarthest_px + 1;
    for (int b = 0; b < marks.height(); ++b) {
        for (int a = 0; a < marks.width(); ++a) {
            if (marks.at(a, b) != 0)
                nearest = std::min(nearest, std::max(std::abs(a - u), std::abs(b - v)));
        }
    }
    return static_cast<std::uint8_t>(nearest > kFarthest_px ? 255 : nearest);
}

TEST(DistanceToMarks, IsTheChessboardDistanceOnEveryProcessorAndThread) {
    Rng rng(5);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 40}, {40, 25}, {64, 3}, {150, 70}}) {
        Image<std::uint8_t> marks(width, height, 0);
        for (int n = 0; n < 6; ++n) {
            marks.at(static_cast<int>(rng.below(static_cast<std::uint64_t>(width))),
                     static_cast<int>(rng.below(static_cast<std::uint64_t>(height)))) = 255;
        }
        Image<std::uint8_t> expected(width, height);
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) expected.at(u, v) = distance_plainly(marks, u, v);
        }
        Threads threads(2);
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Image<std::uint8_t> distance;
            distance_to_marks(threads, marks, distance);
            EXPECT_EQ(distance, expected) << hwy::TargetName(target) << " " << width;
        }
        hwy::SetSupportedTargetsForTest(0);
    }
    Serial serial;
    Image<std::uint8_t> distance;
    distance_to_marks(serial, Image<std::uint8_t>(40, 25, 0), distance);
    EXPECT_EQ(distance.at(0, 0), 255);
}

TEST(CountUnknown, CountsTheWindowInsideTheImage) {
    constexpr int kRadius = 3;
    Rng rng(6);
    Image<float> image(37, 70, 1.0F);
    for (int n = 0; n < 600; ++n)
        image.at(static_cast<int>(rng.below(37)), static_cast<int>(rng.below(70))) = kNanF;
    Serial serial;
    UnknownCounts counts;
    count_unknown(serial, image, kRadius, counts);
    EXPECT_EQ(counts.radius_px, kRadius);
    for (int v = 0; v < 70; ++v) {
        for (int u = 0; u < 37; ++u) {
            int unknown = 0;
            int all = 0;
            for (int b = v - kRadius; b <= v + kRadius; ++b) {
                for (int a = u - kRadius; a <= u + kRadius; ++a) {
                    if (!image.contains(a, b)) continue;
                    ++all;
                    unknown += std::isnan(image.at(a, b)) ? 1 : 0;
                }
            }
            ASSERT_EQ(counts.pixels.at(u, v), unknown) << u << " " << v;
            ASSERT_EQ(window_span(u, kRadius, 37) * window_span(v, kRadius, 70), all);
        }
    }
}

/// On every processor, the smallest known value of the 5 x 5 pixels that lie in the image.
TEST(SmallestNearby, IsTheSmallestKnownValueOfTheWindow) {
    Rng rng(8);
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{3, 40}, std::pair{150, 70}}) {
        Image<float> disparity_px(width, height);
        for (std::size_t i = 0; i < disparity_px.size(); ++i)
            disparity_px.data()[i] =
                rng.uniform() < 0.6 ? kNanF : static_cast<float>(rng.uniform(1.0, 60.0));
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Backwards backwards;
            Image<float> smallest_px;
            smallest_nearby(backwards, disparity_px, smallest_px);
            for (int v = 0; v < height; ++v) {
                for (int u = 0; u < width; ++u) {
                    float expected_px = std::numeric_limits<float>::infinity();
                    for (int y = std::max(0, v - 2); y <= std::min(height - 1, v + 2); ++y)
                        for (int x = std::max(0, u - 2); x <= std::min(width - 1, u + 2); ++x)
                            expected_px = std::fmin(expected_px, disparity_px.at(x, y));
                    ASSERT_EQ(smallest_px.at(u, v), expected_px)
                        << u << ", " << v << " on " << hwy::TargetName(target);
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

}  // namespace
}  // namespace surefoot::stereo
