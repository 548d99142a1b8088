// SPDX-License-Identifier: Apache-2.0
#include "sim/texture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "sim/texture_patterns.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr float kQuantum = 1.0F / 127.0F;
/// Multiple of the tile that keeps texel coordinates positive: truncation is then a floor.
constexpr double kPositive_texel = 1024.0 * TextureTable::kSize;
/// Coarse blotches, many times the finest detail in size, hide that the tile repeats.
constexpr double kBlotchScale = 1.0 / 13.7;
constexpr float kBlotchWeight = 0.35F;
constexpr int kMaxTaps = 4;

/// log2 to within 0.09 and without libm: exponent plus mantissa, linear between powers of two.
float fast_log2(float x) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const int exponent = static_cast<int>(bits >> 23U) - 127;
    const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
    return static_cast<float>(exponent) + mantissa - 1.0F;
}

std::vector<std::int8_t> quantised(const Image<float>& field) {
    std::vector<std::int8_t> texels(field.size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        texels[i] = static_cast<std::int8_t>(std::lround(field.data()[i] * 127.0F));
    }
    return texels;
}

Image<float> halved(const Image<float>& field) {
    Image<float> half(field.width() / 2, field.height() / 2);
    for (int y = 0; y < half.height(); ++y) {
        const float* a = field.row(2 * y);
        const float* b = field.row(2 * y + 1);
        for (int x = 0; x < half.width(); ++x, a += 2, b += 2) {
            half.at(x, y) = 0.25F * (a[0] + a[1] + b[0] + b[1]);
        }
    }
    return half;
}

}  // namespace

const char* to_string(Pattern pattern) noexcept {
    return kPatternNames[static_cast<std::size_t>(pattern)];
}

void Material::describe(ConfigVisitor& visitor) {
    visitor.enumeration("pattern", pattern, kPatternNames, "kind of surface");
    visitor.number("albedo", albedo, 0.0, 1.0, "mean reflectance");
    visitor.number("contrast", contrast, 0.0, 1.0, "of the pattern; 0 = uniform");
    visitor.number("texel_m", texel_m, 1e-4, 0.1, "size of the finest detail");
    visitor.number("yaw_rad", yaw_rad, -10.0, 10.0, "turn of the pattern on the surface");
    visitor.enumeration("finish", finish, kFinishNames, "what happens to light");
    visitor.number("gloss", gloss, 0.0, 1.0, "mirror: share reflected; glass: share let through");
}

TextureTable::TextureTable(Pattern pattern, std::uint64_t seed) {
    Image<float> field = draw_pattern(pattern, kSize, seed);
    while (true) {
        levels_.push_back(quantised(field));
        if (field.width() == 1) break;
        field = halved(field);
    }
}

float TextureTable::texel(int level, int x, int y) const noexcept {
    const int mask = (kSize >> level) - 1;
    const int index = (y & mask) * (mask + 1) + (x & mask);
    return static_cast<float>(
               levels_[static_cast<std::size_t>(level)][static_cast<std::size_t>(index)]) *
           kQuantum;
}

float TextureTable::bilinear(int level, double u_texel, double v_texel) const noexcept {
    // Centres of texels lie at half-integers of their own level.
    const double scale = 1.0 / static_cast<double>(1 << level);
    const double u = u_texel * scale + (kPositive_texel - 0.5);
    const double v = v_texel * scale + (kPositive_texel - 0.5);
    const auto iu = static_cast<std::int64_t>(u);
    const auto iv = static_cast<std::int64_t>(v);
    const auto fu = static_cast<float>(u - static_cast<double>(iu));
    const auto fv = static_cast<float>(v - static_cast<double>(iv));
    const int size = kSize >> level;
    const int x0 = static_cast<int>(iu) & (size - 1);
    const int x1 = (x0 + 1) & (size - 1);
    const int y0 = static_cast<int>(iv) & (size - 1);
    const int y1 = (y0 + 1) & (size - 1);
    const std::int8_t* texels = levels_[static_cast<std::size_t>(level)].data();
    const auto at = [&](int x, int y) { return static_cast<float>(texels[y * size + x]); };
    const float low = at(x0, y0) + fu * (at(x1, y0) - at(x0, y0));
    const float high = at(x0, y1) + fu * (at(x1, y1) - at(x0, y1));
    return (low + fv * (high - low)) * kQuantum;
}

float TextureTable::sample(double u_texel, double v_texel, float level) const noexcept {
    const float coarsest = static_cast<float>(levels() - 1);
    const float clamped = std::clamp(level, 0.0F, coarsest);
    const int fine = static_cast<int>(clamped);
    const float share = clamped - static_cast<float>(fine);
    const float value = bilinear(fine, u_texel, v_texel);
    if (share == 0.0F) return value;
    return value + share * (bilinear(fine + 1, u_texel, v_texel) - value);
}

Textures::Textures(const std::vector<Material>& materials, std::uint64_t seed) {
    std::array<int, kPatterns> table_of{};
    table_of.fill(-1);
    for (const Material& material : materials) {
        int& table = table_of[static_cast<std::size_t>(material.pattern)];
        if (table < 0) {
            table = static_cast<int>(tables_.size());
            tables_.emplace_back(material.pattern, seed);
        }
        materials_.push_back({material,
                              static_cast<std::size_t>(table),
                              1.0 / material.texel_m,
                              std::cos(material.yaw_rad),
                              std::sin(material.yaw_rad),
                              mix_seed(seed, material.seed)});
    }
}

float Textures::reflectance(
    int material, int surface, double u_m, double v_m, const Footprint& footprint) const noexcept {
    const Placed& placed = materials_[static_cast<std::size_t>(material)];
    const TextureTable& table = tables_[placed.table];
    const std::uint64_t shift = mix_seed(placed.seed, static_cast<std::uint64_t>(surface));
    const auto turned_u = [&](double u, double v) {
        return (placed.cos_yaw * u + placed.sin_yaw * v) * placed.texels_per_m;
    };
    const auto turned_v = [&](double u, double v) {
        return (placed.cos_yaw * v - placed.sin_yaw * u) * placed.texels_per_m;
    };
    const double u_texel = turned_u(u_m, v_m) + static_cast<double>(shift & 1023U);
    const double v_texel = turned_v(u_m, v_m) + static_cast<double>((shift >> 10U) & 1023U);

    const double stretch = footprint.major_m / footprint.minor_m;
    const int taps = std::clamp(static_cast<int>(std::lround(stretch)), 1, kMaxTaps);
    const double tap_m = std::max(footprint.minor_m, footprint.major_m / taps);
    const float level = fast_log2(static_cast<float>(tap_m * placed.texels_per_m));
    const double step_u = turned_u(footprint.axis_u, footprint.axis_v) * footprint.major_m / taps;
    const double step_v = turned_v(footprint.axis_u, footprint.axis_v) * footprint.major_m / taps;
    float sum = 0.0F;
    for (int tap = 0; tap < taps; ++tap) {
        const double along = tap - 0.5 * (taps - 1);
        sum += table.sample(u_texel + along * step_u, v_texel + along * step_v, level);
    }
    const float coarse_level =
        fast_log2(static_cast<float>(footprint.major_m * placed.texels_per_m * kBlotchScale));
    const float blotch =
        table.sample(u_texel * kBlotchScale, v_texel * kBlotchScale, std::max(coarse_level, 2.0F));
    const float value = sum / static_cast<float>(taps) + kBlotchWeight * blotch;
    const auto albedo = static_cast<float>(placed.material.albedo);
    const auto contrast = static_cast<float>(placed.material.contrast);
    return std::clamp(albedo * (1.0F + contrast * value), 0.0F, 1.0F);
}

}  // namespace surefoot::sim
