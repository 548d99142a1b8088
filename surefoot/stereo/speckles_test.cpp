// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/speckles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::stereo {
namespace {

/// The definition: flood fill from every pixel, count, remove.
Image<float> flooded(const Image<float>& in, int min_size, double same_px) {
    Image<float> out = in;
    Image<std::uint8_t> seen(in.width(), in.height(), 0);
    for (int v0 = 0; v0 < in.height(); ++v0) {
        for (int u0 = 0; u0 < in.width(); ++u0) {
            if (seen.at(u0, v0) != 0 || std::isnan(in.at(u0, v0))) continue;
            std::vector<std::pair<int, int>> island = {{u0, v0}};
            seen.at(u0, v0) = 1;
            for (std::size_t next = 0; next < island.size(); ++next) {
                const auto [u, v] = island[next];
                for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                    if (!in.contains(u + du, v + dv) || seen.at(u + du, v + dv) != 0) continue;
                    const double step = std::abs(static_cast<double>(in.at(u + du, v + dv)) -
                                                 static_cast<double>(in.at(u, v)));
                    if (!(step <= same_px)) continue;
                    seen.at(u + du, v + dv) = 1;
                    island.emplace_back(u + du, v + dv);
                }
            }
            if (static_cast<int>(island.size()) >= min_size) continue;
            for (const auto& [u, v] : island) out.at(u, v) = kNanF;
        }
    }
    return out;
}

/// Several bands, with islands that cross one or more band borders.
TEST(SpeckleFilter, IsTheFloodFillForEveryExecutor) {
    SpeckleFilter filter;
    Backwards backwards;
    Threads two(2);
    Executor* const executors[] = {&serial(), &backwards, &two};
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        Rng rng(seed);
        Image<float> image(1 + static_cast<int>(rng.uniform(0.0, 60.0)),
                           1 + static_cast<int>(rng.uniform(0.0, 140.0)));
        for (std::size_t i = 0; i < image.size(); ++i) {
            const double luck = rng.uniform();
            image.data()[i] = luck < 0.25
                                  ? kNanF
                                  : static_cast<float>(luck < 0.6 ? 10.0 : rng.uniform(8.0, 14.0));
        }
        const Image<float> expected = flooded(image, 12, 1.0);
        filter.remove(*executors[seed % 3], 12, 1.0, image);
        int known = 0;
        for (std::size_t i = 0; i < image.size(); ++i) {
            const bool both_unknown = std::isnan(image.data()[i]) && std::isnan(expected.data()[i]);
            ASSERT_TRUE(both_unknown || image.data()[i] == expected.data()[i]) << seed;
            known += std::isnan(image.data()[i]) ? 0 : 1;
        }
        if (image.size() > 400) {
            EXPECT_GT(known, 0) << "the case tests nothing";
        }
    }
}

/// One snake-shaped island through all bands. It must stay whole, although each part alone is too
/// small.
TEST(SpeckleFilter, JoinsOverTheBordersOfBands) {
    constexpr int kWidth = 9;
    constexpr int kHeight = 100;
    for (const int min_size : {kHeight, kHeight + 1}) {
        Image<float> image(kWidth, kHeight, kNanF);
        for (int v = 0; v < kHeight; ++v) image.at(4, v) = 10.0F;
        Backwards backwards;
        SpeckleFilter().remove(backwards, min_size, 1.0, image);
        for (int v = 0; v < kHeight; ++v)
            ASSERT_EQ(std::isnan(image.at(4, v)), min_size > kHeight) << min_size << " row " << v;
    }
}

TEST(SpeckleFilter, NothingInNothingOut) {
    SpeckleFilter filter;
    Image<float> empty;
    filter.remove(serial(), 10, 1.0, empty);
    Image<float> unknown(5, 4, kNanF);
    filter.remove(serial(), 10, 1.0, unknown);
    EXPECT_TRUE(std::isnan(unknown.at(2, 2)));
}

}  // namespace
}  // namespace surefoot::stereo
