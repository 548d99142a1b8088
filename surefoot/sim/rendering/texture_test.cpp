// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/texture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/camera/simd_targets_testing.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/rendering/texture_patterns.hpp"

namespace surefoot::sim {
namespace {

TextureTable::Place at(double texels) {
    return TextureTable::place(texels);
}

struct Moments {
    double mean = 0.0;
    double sigma = 0.0;
};

template <typename Sample>
Moments moments(int count, const Sample& sample) {
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < count; ++i) {
        const double value = static_cast<double>(sample(i));
        sum += value;
        squares += value * value;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0))};
}

TEST(TextureTest, EveryPatternHasContrastAndLosesItWithDistance) {
    for (int p = 0; p < kPatterns; ++p) {
        const auto pattern = static_cast<Pattern>(p);
        const TextureTable table(pattern, 3);
        double previous = 1.0;
        for (const int level : {0, 2, 4, 6, 8}) {
            const int size = TextureTable::kSize >> level;
            const Moments m =
                moments(size * size, [&](int i) { return table.texel(level, i % size, i / size); });
            // Clipping to [-1, 1] may shift the mean a little.
            EXPECT_NEAR(m.mean, 0.0, 0.06) << to_string(pattern) << " level " << level;
            EXPECT_LE(m.sigma, previous + 1e-3) << to_string(pattern) << " level " << level;
            if (level == 0) {
                EXPECT_GT(m.sigma, 0.3) << to_string(pattern);
            }
            previous = m.sigma;
        }
        EXPECT_EQ(table.texel(table.levels() - 1, 0, 0), table.texel(table.levels() - 1, 5, 7));
    }
}

TEST(TextureTest, SamplesInterpolateTexelsAndRepeat) {
    const TextureTable table(Pattern::carpet, 3);
    constexpr double kSize = TextureTable::kSize;
    EXPECT_EQ(table.sample(at(10.5), at(20.5), 0.0F), table.texel(0, 10, 20));
    EXPECT_EQ(table.sample(at(10.5 + kSize), at(20.5 - kSize), 0.0F), table.texel(0, 10, 20));
    const float middle = table.sample(at(11.0), at(20.5), 0.0F);
    EXPECT_NEAR(middle, 0.5F * (table.texel(0, 10, 20) + table.texel(0, 11, 20)), 1e-6F);
    // Centre of texel (3, 5) of level 2 lies at (14, 22) of level 0.
    EXPECT_NEAR(table.sample(at(14.0), at(22.0), 2.0F), table.texel(2, 3, 5), 1e-6F);
    EXPECT_NEAR(table.sample(at(0.25), at(700.0), 0.5F),
                table.sample(at(kSize + 0.25), at(700.0), 0.5F),
                1e-6F);
}

TEST(TextureTest, TilesRepeatWithoutASeam) {
    for (int p = 0; p < kPatterns; ++p) {
        const Image<float> tile = draw_pattern(static_cast<Pattern>(p), TextureTable::kSize, 5);
        const int last = tile.width() - 1;
        // Tiles and boards have a joint there on purpose: compare the border with other joints.
        const auto step = [&](int column) {
            double sum = 0.0;
            for (int y = 0; y < tile.height(); ++y) {
                const int next = column == last ? 0 : column + 1;
                sum += std::abs(static_cast<double>(tile.at(next, y) - tile.at(column, y)));
            }
            return sum / tile.height();
        };
        EXPECT_LT(step(last), 1.5 * std::max(step(127), step(300))) << "pattern " << p;
    }
}

/// Mean of reflectance over the pixel, from many samples of the finest level.
double brute_average(const Textures& textures, double u_m, double v_m, const Footprint& f) {
    constexpr int kSide = 24;
    const Footprint point{1e-5, 1e-5, 1.0, 0.0};
    double sum = 0.0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int row = i / kSide;
        const double along = ((i % kSide + 0.5) / kSide - 0.5) * f.major_m;
        const double across = ((row + 0.5) / kSide - 0.5) * f.minor_m;
        sum += static_cast<double>(textures.reflectance(textures.place(0, 0),
                                                        u_m + along * f.axis_u - across * f.axis_v,
                                                        v_m + along * f.axis_v + across * f.axis_u,
                                                        point));
    }
    return sum / (kSide * kSide);
}

TEST(TextureTest, AFootprintAveragesLikeManySamples) {
    Material material;
    material.pattern = Pattern::patches;
    const Textures textures({material}, 11);
    Rng rng(4);
    for (const Footprint& f : {Footprint{0.006, 0.006, 1.0, 0.0},
                               Footprint{0.010, 0.030, 0.6, 0.8},
                               Footprint{0.040, 0.080, 0.0, 1.0}}) {
        double error2 = 0.0;
        double spread2 = 0.0;
        double mean = 0.0;
        constexpr int kPlaces = 300;
        std::vector<double> averages;
        for (int i = 0; i < kPlaces; ++i) {
            const double u_m = rng.uniform(-4.0, 4.0);
            const double v_m = rng.uniform(-4.0, 4.0);
            const double filtered =
                static_cast<double>(textures.reflectance(textures.place(0, 0), u_m, v_m, f));
            averages.push_back(brute_average(textures, u_m, v_m, f));
            error2 += (filtered - averages.back()) * (filtered - averages.back());
            mean += averages.back() / kPlaces;
        }
        for (const double average : averages) spread2 += (average - mean) * (average - mean);
        // Trilinear kernels are wider than a box: they lose some contrast, never invent any.
        EXPECT_LT(std::sqrt(error2), 0.45 * std::sqrt(spread2)) << f.minor_m << " x " << f.major_m;
    }
}

TEST(TextureTest, FarSurfacesDoNotAlias) {
    Material material;
    const Textures textures({material}, 11);
    const Footprint near{0.003, 0.003, 1.0, 0.0};
    const Footprint far{0.5, 1.0, 1.0, 0.0};
    const auto sigma = [&](const Footprint& f) {
        return moments(2000,
                       [&](int i) {
                           return textures.reflectance(
                               textures.place(0, 0), 0.0137 * i, 0.0071 * i, f);
                       })
            .sigma;
    };
    EXPECT_GT(sigma(near), 0.08);
    // The remaining differences are true: blotches up to 3 m in size.
    EXPECT_LT(sigma(far), 0.25 * sigma(near));
}

TEST(TextureTest, AWhiteWallHasNearlyNoContrast) {
    Material material;
    material.pattern = Pattern::white_wall;
    material.albedo = 0.8;
    const Textures textures({material}, 11);
    const Placement placement = textures.place(0, 0);
    const Footprint near{0.003, 0.004, 1.0, 0.0};
    const Moments m = moments(
        4000, [&](int i) { return textures.reflectance(placement, 0.0137 * i, 0.0071 * i, near); });
    EXPECT_NEAR(m.mean, 0.8, 0.01);
    EXPECT_LT(m.sigma / m.mean, 0.015);
    EXPECT_GT(m.sigma / m.mean, 0.002);
}

TEST(TextureTest, AMeanOfTapsIsTheMeanOfTheirSamples) {
    const TextureTable table(Pattern::tiles, 3);
    Rng rng(8);
    for (int i = 0; i < 200; ++i) {
        const auto u = at(rng.uniform(-3000.0, 3000.0));
        const auto v = at(rng.uniform(-3000.0, 3000.0));
        const auto du = at(rng.uniform(-9.0, 9.0));
        const auto dv = at(rng.uniform(-9.0, 9.0));
        const auto level = static_cast<float>(rng.uniform(-1.0, 11.0));
        for (std::uint32_t taps = 1; taps <= 4; ++taps) {
            float sum = 0.0F;
            for (std::uint32_t k = 0; k < taps; ++k) {
                sum += table.sample(u + k * du, v + k * dv, level);
            }
            EXPECT_NEAR(table.mean(u, v, du, dv, static_cast<int>(taps), level),
                        sum / static_cast<float>(taps),
                        2e-6F);
        }
    }
}

/// Whatever the instruction set, and also beyond what a scene needs.
TEST(TextureTest, ABatchHasTheBitsOfSinglePlaces) {
    Material material;
    material.pattern = Pattern::tiles;
    const Textures textures({material}, 11);
    const Placement placement = textures.place(0, 3);
    Rng rng(6);
    for (const std::size_t count : {std::size_t{256}, std::size_t{1}, std::size_t{37}}) {
        TextureBatch batch;
        std::vector<float> single(count);
        for (std::size_t i = 0; i < count; ++i) {
            TexelLook look;
            look.at_texel = {rng.uniform(-1e5, 1e5), rng.uniform(-1e5, 1e5)};
            look.along_texel = {static_cast<float>(rng.uniform(-500.0, 500.0)),
                                static_cast<float>(i % 9 == 0 ? 0.0 : rng.normal())};
            look.minor_texel = static_cast<float>(std::exp(rng.uniform(-6.0, 9.0)));
            look.cosine = static_cast<float>(rng.uniform(0.02, 1.0));
            batch.add(look);
            single[i] = textures.reflectance(placement, look);
        }
        camera::test::on_every_target([&](const char* target) {
            std::vector<float> together(count);
            textures.reflectances(placement, batch, together.data());
            EXPECT_EQ(together, single) << count << " on " << target;
        });
        if (count > 1) {
            const auto [least, most] = std::minmax_element(single.begin(), single.end());
            EXPECT_GT(*most - *least, 0.2F);
        }
    }
}

TEST(TextureTest, SeedsAndSurfacesDiffer) {
    const Material material;
    const Footprint f{0.003, 0.004, 1.0, 0.0};
    const Textures a({material}, 1);
    const Textures same({material}, 1);
    const Textures b({material}, 2);
    int equal_seed = 0;
    int equal_surface = 0;
    for (int i = 0; i < 1000; ++i) {
        const double u_m = 0.01 * i;
        EXPECT_EQ(a.reflectance(a.place(0, 0), u_m, 0.3, f),
                  same.reflectance(same.place(0, 0), u_m, 0.3, f));
        equal_seed +=
            a.reflectance(a.place(0, 0), u_m, 0.3, f) == b.reflectance(b.place(0, 0), u_m, 0.3, f)
                ? 1
                : 0;
        equal_surface +=
            a.reflectance(a.place(0, 0), u_m, 0.3, f) == a.reflectance(a.place(0, 1), u_m, 0.3, f)
                ? 1
                : 0;
    }
    EXPECT_LT(equal_seed, 20);
    EXPECT_LT(equal_surface, 20);
}

}  // namespace
}  // namespace surefoot::sim
