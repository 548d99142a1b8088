// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/clipped.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/scene_testing.hpp"

namespace surefoot::stereo {
namespace {

using test::Scene;
using test::SceneConfig;
using test::SyntheticPair;

/// The definition, pixel by pixel.
bool is_clipped_at(const Image<std::uint8_t>& grey, int u, int v) {
    bool all_white = true;
    bool all_black = true;
    for (int dv = -ClippedFilter::kReachY_px; dv <= ClippedFilter::kReachY_px; ++dv) {
        for (int du = -ClippedFilter::kReachX_px; du <= ClippedFilter::kReachX_px; ++du) {
            if (!grey.contains(u + du, v + dv)) continue;
            all_white = all_white && grey.at(u + du, v + dv) >= 254;
            all_black = all_black && grey.at(u + du, v + dv) <= 1;
        }
    }
    return all_white || all_black;
}

TEST(ClippedFilter, IsItsDefinitionForEveryExecutor) {
    ClippedFilter filter;
    Backwards backwards;
    Threads two(2);
    Executor* const executors[] = {&serial(), &backwards, &two};
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        Rng rng(seed);
        const int width = 1 + static_cast<int>(rng.uniform(0.0, 90.0));
        const int height = 1 + static_cast<int>(rng.uniform(0.0, 140.0));
        Image<std::uint8_t> grey(width, height, 128);
        for (int box = 0; box < 6; ++box) {
            const int levels[] = {255, 254, 253, 0, 1, 2};
            const int left = static_cast<int>(rng.uniform(0.0, width));
            const int top = static_cast<int>(rng.uniform(0.0, height));
            for (int v = top; v < std::min(height, top + 30); ++v)
                for (int u = left; u < std::min(width, left + 30); ++u)
                    grey.at(u, v) = static_cast<std::uint8_t>(levels[box]);
        }
        Image<float> disparity_px(width, height, 7.0F);
        filter.remove(grey.view(), *executors[seed % 3], disparity_px);
        int gone = 0;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                ASSERT_EQ(std::isnan(disparity_px.at(u, v)), is_clipped_at(grey, u, v))
                    << "seed " << seed << " at " << u << ", " << v;
                gone += std::isnan(disparity_px.at(u, v)) ? 1 : 0;
            }
        }
        if (width > 40 && height > 40) {
            EXPECT_GT(gone, 0) << "seed " << seed << " has no clipped area";
        }
    }
}

/// A search carries the disparity of the window's frame, or another one, into the white area, and
/// nothing in the image contradicts it.
TEST(ClippedFilter, MatchersSayNothingInsideAWhiteWindow) {
    SyntheticPair pair = Scene(SceneConfig{}).render();
    const int width = pair.left.width();
    const int height = pair.left.height();
    const auto is_inside = [&](int u, int v, int margin) {
        return u >= width / 3 + margin && u < 2 * width / 3 - margin && v >= height / 4 + margin &&
               v < height / 2 - margin;
    };
    constexpr int kFrame_px = 20;  // disparity
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            if (!is_inside(u, v, 0)) continue;
            pair.left.at(u, v) = 255;
            pair.right.at(u - kFrame_px, v) = 255;
        }
    }
    for (const Algorithm algorithm : {Algorithm::census, Algorithm::sgbm, Algorithm::bm}) {
        MatcherConfig config;
        config.algorithm = algorithm;
        DepthImage depth;
        make_matcher(config)->match(pair.left.view(), pair.right.view(), serial(), depth);
        int inside = 0;
        int known_outside = 0;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                const bool known = !std::isnan(depth.disparity_px.at(u, v));
                if (is_inside(u, v, ClippedFilter::kReachX_px + 1)) {
                    ASSERT_FALSE(known) << kAlgorithmNames[static_cast<int>(algorithm)] << " at "
                                        << u << ", " << v << ": " << depth.disparity_px.at(u, v);
                    ++inside;
                } else if (known && !is_inside(u, v, 0)) {
                    ++known_outside;
                }
            }
        }
        EXPECT_GT(inside, 1000);
        EXPECT_GT(known_outside, width * height / 4);
    }
}

}  // namespace
}  // namespace surefoot::stereo
