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
/// A pattern value of 0 as it is stored.
constexpr float kMiddle = 127.0F;
/// Coarse blotches, many times the finest detail in size, hide that the tile repeats.
constexpr float kBlotchScale = 1.0F / 13.7F;
constexpr float kBlotchWeight = 0.35F;
constexpr std::array<float, 5> kInverse{0.0F, 1.0F, 1.0F / 2.0F, 1.0F / 3.0F, 1.0F / 4.0F};

/// log2 to within 0.09 and without libm: exponent plus mantissa, linear between powers of two.
float fast_log2(float x) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const int exponent = static_cast<int>(bits >> 23U) - 127;
    const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
    return static_cast<float>(exponent) + mantissa - 1.0F;
}

/// Stored value times 2^16 at a place of a level. Whole numbers: two texels above each other share
/// a word, so that one multiplication weighs both. Weights are steps of 1/256.
inline std::uint32_t bilinear(const std::uint8_t* texels,
                              int level,
                              TextureTable::Place u,
                              TextureTable::Place v) noexcept {
    // Centres of texels lie at half-integers of their own level.
    const std::uint32_t u_level = (u >> level) - 0x8000U;
    const std::uint32_t v_level = (v >> level) - 0x8000U;
    const std::uint32_t mask = (static_cast<std::uint32_t>(TextureTable::kSize) >> level) - 1U;
    const std::uint32_t y = (v_level >> 16U) & mask;
    const std::uint8_t* column = texels + ((u_level >> 16U) & mask);
    const std::uint8_t* low = column + y * (mask + 2U);
    const std::uint8_t* high = column + ((y + 1U) & mask) * (mask + 2U);
    const std::uint32_t left = low[0] | (static_cast<std::uint32_t>(high[0]) << 16U);
    const std::uint32_t right = low[1] | (static_cast<std::uint32_t>(high[1]) << 16U);
    const std::uint32_t fu = (u_level >> 8U) & 255U;
    const std::uint32_t fv = (v_level >> 8U) & 255U;
    const std::uint32_t both = left * (256U - fu) + right * fu;
    return (both & 0xffffU) * (256U - fv) + (both >> 16U) * fv;
}

/// Appends rows of texels, each with its first one again at the end.
void append_quantised(const Image<float>& field, std::vector<std::uint8_t>& texels) {
    for (int y = 0; y < field.height(); ++y) {
        for (int x = 0; x <= field.width(); ++x) {
            const float value = field.at(x < field.width() ? x : 0, y);
            texels.push_back(static_cast<std::uint8_t>(std::lround(value * kMiddle + kMiddle)));
        }
    }
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

float pattern_strength(Pattern pattern) noexcept {
    return pattern == Pattern::white_wall ? 0.05F : 1.0F;
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
    static_assert(kSize == 1 << (kLevels - 1));
    Image<float> field = draw_pattern(pattern, kSize, seed);
    for (std::size_t level = 0; level < kLevels; ++level) {
        first_[level] = texels_.size();
        append_quantised(field, texels_);
        if (field.width() > 1) field = halved(field);
    }
}

float TextureTable::texel(int level, int x, int y) const noexcept {
    const int mask = (kSize >> level) - 1;
    const int index = (y & mask) * (mask + 2) + (x & mask);
    const std::uint8_t stored =
        texels_[first_[static_cast<std::size_t>(level)] + static_cast<std::size_t>(index)];
    return (static_cast<float>(stored) - kMiddle) * kQuantum;
}

float TextureTable::sample(Place u, Place v, float level) const noexcept {
    return mean(u, v, 0, 0, 1, level);
}

float TextureTable::mean(
    Place u, Place v, Place du, Place dv, int taps, float level) const noexcept {
    const float clamped = std::clamp(level, 0.0F, static_cast<float>(kLevels - 1));
    const int fine = static_cast<int>(clamped);
    const float share = clamped - static_cast<float>(fine);
    const int coarse = share > 0.0F ? fine + 1 : fine;
    const std::uint8_t* fine_texels = texels_.data() + first_[static_cast<std::size_t>(fine)];
    const std::uint8_t* coarse_texels = texels_.data() + first_[static_cast<std::size_t>(coarse)];
    std::uint32_t fine_sum = 0;
    std::uint32_t coarse_sum = 0;
    for (int tap = 0; tap < taps; ++tap, u += du, v += dv) {
        fine_sum += bilinear(fine_texels, fine, u, v);
        if (share > 0.0F) coarse_sum += bilinear(coarse_texels, coarse, u, v);
    }
    const float unit = kInverse[static_cast<std::size_t>(taps)] / 65536.0F;
    const float value = static_cast<float>(fine_sum) * unit;
    if (share == 0.0F) return (value - kMiddle) * kQuantum;
    const float blurred = static_cast<float>(coarse_sum) * unit;
    return (value + share * (blurred - value) - kMiddle) * kQuantum;
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
        materials_.push_back(
            {material, static_cast<std::size_t>(table), mix_seed(seed, material.seed)});
    }
}

Placement Textures::place(int material, int surface) const noexcept {
    const Known& known = materials_[static_cast<std::size_t>(material)];
    const std::uint64_t shift = mix_seed(known.seed, static_cast<std::uint64_t>(surface));
    Placement placement;
    placement.table = known.table;
    placement.albedo = static_cast<float>(known.material.albedo);
    placement.contrast =
        static_cast<float>(known.material.contrast) * pattern_strength(known.material.pattern);
    placement.texels_per_m = 1.0 / known.material.texel_m;
    placement.along = std::cos(known.material.yaw_rad) * placement.texels_per_m;
    placement.across = std::sin(known.material.yaw_rad) * placement.texels_per_m;
    placement.u_texel = static_cast<double>(shift & 1023U);
    placement.v_texel = static_cast<double>((shift >> 10U) & 1023U);
    return placement;
}

float Textures::reflectance(const Placement& placement,
                            double u_m,
                            double v_m,
                            const Footprint& footprint) const noexcept {
    const double minor_texel = footprint.minor_m * placement.texels_per_m;
    const Eigen::Vector2d at_texel(
        placement.along * u_m + placement.across * v_m + placement.u_texel,
        placement.along * v_m - placement.across * u_m + placement.v_texel);
    const Eigen::Vector2d along(
        placement.along * footprint.axis_u + placement.across * footprint.axis_v,
        placement.along * footprint.axis_v - placement.across * footprint.axis_u);
    return reflectance(placement,
                       at_texel,
                       along.cast<float>(),
                       static_cast<float>(minor_texel),
                       static_cast<float>(footprint.minor_m / footprint.major_m));
}

float Textures::reflectance(const Placement& placement,
                            const Eigen::Vector2d& at_texel,
                            const Eigen::Vector2f& along_texel,
                            float minor_texel,
                            float cosine) const noexcept {
    const TextureTable& table = tables_[placement.table];
    // As many taps as the footprint is longer than wide, to the nearest whole number.
    const int taps = 1 + (cosine < 2.0F / 3.0F) + (cosine < 2.0F / 5.0F) + (cosine < 2.0F / 7.0F);
    const float major_texel = minor_texel / cosine;
    const float step_texel = major_texel * kInverse[static_cast<std::size_t>(taps)];
    const float level = fast_log2(std::max(minor_texel, step_texel));
    const float length = std::sqrt(along_texel.squaredNorm());
    const Eigen::Vector2d step =
        (along_texel * (length > 0.0F ? step_texel / length : 0.0F)).cast<double>();
    const Eigen::Vector2d first = at_texel - 0.5 * (taps - 1) * step;
    const float detail = table.mean(TextureTable::place(first.x()),
                                    TextureTable::place(first.y()),
                                    TextureTable::place(step.x()),
                                    TextureTable::place(step.y()),
                                    taps,
                                    level);
    const float blotch =
        table.sample(TextureTable::place(at_texel.x() * static_cast<double>(kBlotchScale)),
                     TextureTable::place(at_texel.y() * static_cast<double>(kBlotchScale)),
                     std::max(fast_log2(major_texel * kBlotchScale), 2.0F));
    const float value = detail + kBlotchWeight * blotch;
    return std::clamp(placement.albedo * (1.0F + placement.contrast * value), 0.0F, 1.0F);
}

}  // namespace surefoot::sim
