// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/remap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "surefoot/camera/simd_targets_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::camera {
namespace {

GreyImage random_image(int width, int height, Rng& rng) {
    GreyImage image(width, height);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(rng.below(256));
    return image;
}

/// Random positions, one pixel in eight without a source, and the corners of the source.
struct Places {
    RemapTable table;
    cv::Mat source_px;  ///< CV_32FC2, far outside for pixels without a source
};

Places random_places(int width, int height, int source_width, int source_height, Rng& rng) {
    Places places{RemapTable(width, height, source_width, source_height),
                  cv::Mat(height, width, CV_32FC2, cv::Scalar(-100.0, -100.0))};
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            if (rng.below(8) == 0) continue;
            const auto along = [&](int size) {
                if (rng.below(8) == 0) return 0.0F;
                if (rng.below(8) == 0) return static_cast<float>(size - 1);
                return static_cast<float>(rng.uniform() * (size - 1));
            };
            const cv::Vec2f place(along(source_width), along(source_height));
            places.table.set(u, v, place[0], place[1]);
            places.source_px.at<cv::Vec2f>(v, u) = place;
        }
    }
    return places;
}

TEST(Remap, EveryTargetGivesTheBytesOfTheReference) {
    Rng rng(7);
    // Sizes around those of vectors and blocks, and the smallest valid sources.
    const struct {
        int width, height, source_width, source_height;
    } sizes[] = {{1, 1, 2, 2},
                 {3, 1, 2, 5},
                 {31, 1, 9, 2},
                 {33, 3, 40, 30},
                 {513, 1, 64, 64},
                 {511, 2, 3, 3},
                 {160, 97, 211, 90},
                 {0, 0, 2, 2}};
    for (const auto& size : sizes) {
        const GreyImage source = random_image(size.source_width, size.source_height, rng);
        const Places places =
            random_places(size.width, size.height, size.source_width, size.source_height, rng);
        GreyImage expected;
        places.table.remap_reference(source.view(), expected);
        test::on_every_target([&](const char* target) {
            GreyImage out;
            places.table.remap(source.view(), out);
            EXPECT_EQ(out, expected) << target << " " << size.width << "x" << size.height;
        });
    }
}

TEST(Remap, EveryPairOfFractionsAndExtremeValues) {
    // Sources of black and white pixels reach the limits of 16 bits.
    constexpr int kSteps = RemapTable::kUnits + 1;
    RemapTable table(kSteps, kSteps, 2, 2);
    for (int v = 0; v < kSteps; ++v) {
        for (int u = 0; u < kSteps; ++u)
            table.set(u, v, static_cast<float>(u) / 32.0F, static_cast<float>(v) / 32.0F);
    }
    for (int bits = 0; bits < 16; ++bits) {
        GreyImage source(2, 2);
        for (int i = 0; i < 4; ++i) source.data()[i] = ((bits >> i) & 1) != 0 ? 255 : 0;
        test::on_every_target([&](const char* target) {
            GreyImage out;
            table.remap(source.view(), out);
            for (int v = 0; v < kSteps; ++v) {
                for (int u = 0; u < kSteps; ++u) {
                    const double x = u / 32.0;
                    const double y = v / 32.0;
                    const double exact =
                        (1 - y) * ((1 - x) * source.at(0, 0) + x * source.at(1, 0)) +
                        y * ((1 - x) * source.at(0, 1) + x * source.at(1, 1));
                    ASSERT_EQ(out.at(u, v), std::floor(exact + 0.5))
                        << target << " " << u << " " << v << " " << bits;
                }
            }
        });
    }
}

TEST(Remap, TheSameBytesAsOpenCv) {
    Rng rng(3);
    const GreyImage source = random_image(211, 90, rng);
    const Places places = random_places(200, 120, 211, 90, rng);
    cv::Mat position;
    cv::Mat fraction;
    cv::convertMaps(places.source_px, cv::noArray(), position, fraction, CV_16SC2);
    cv::Mat peer;
    cv::remap(cv::Mat(90, 211, CV_8UC1, const_cast<std::uint8_t*>(source.data())),
              peer,
              position,
              fraction,
              cv::INTER_LINEAR,
              cv::BORDER_CONSTANT,
              0);
    GreyImage out;
    places.table.remap(source.view(), out);
    for (int v = 0; v < 120; ++v) {
        for (int u = 0; u < 200; ++u)
            ASSERT_EQ(out.at(u, v), peer.at<std::uint8_t>(v, u)) << u << " " << v;
    }
}

}  // namespace
}  // namespace surefoot::camera
