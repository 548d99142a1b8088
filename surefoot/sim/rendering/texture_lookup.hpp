// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "surefoot/sim/rendering/texture.hpp"

/// Arithmetic of one texture look-up without branches, so that compilers vectorise it. Uses only
/// whole numbers and operations that IEEE 754 rounds exactly: the bits do not depend on the
/// register width.
namespace surefoot::sim::lookup {

inline constexpr float kQuantum = 1.0F / 127.0F;
/// Stored code of the pattern value 0.
inline constexpr float kMiddle = 127.0F;
inline constexpr float kBlotchWeight = 0.35F;
inline constexpr float kBlotchLeastLevel = 2.0F;

inline constexpr int kTopLevel = TextureTable::levels() - 1;
static_assert(TextureTable::kSize == 1 << kTopLevel);

/// Number of cells before the first cell of a level. A level and all coarser levels together have 1
/// + 4 + 16 + ... cells: 1010...1 in binary.
inline std::uint32_t first_cell(std::uint32_t level) noexcept {
    constexpr std::uint32_t kAll = ((4U << (2U * kTopLevel)) - 1U) / 3U;
    return kAll - (kAll >> (2U * level));
}

/// log2 to within 0.09 and without libm: exponent plus mantissa, linear between powers of two.
inline float fast_log2(float x) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const int exponent = static_cast<int>(bits >> 23U) - 127;
    const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
    return static_cast<float>(exponent) + mantissa - 1.0F;
}

/// Stored value times 2^16 at a position of a level. Integer arithmetic: two vertically adjacent
/// texels share a word, so that one multiplication weighs both. Weights are multiples of 1/256.
inline std::uint32_t bilinear(const std::uint32_t* cells,
                              std::uint32_t level,
                              TextureTable::Place u,
                              TextureTable::Place v) noexcept {
    // Centres of texels lie at half-integers of their own level.
    const std::uint32_t u_level = (u >> level) - 0x8000U;
    const std::uint32_t v_level = (v >> level) - 0x8000U;
    const std::uint32_t bits = kTopLevel - level;
    const std::uint32_t mask = (1U << bits) - 1U;
    const std::uint32_t x = (u_level >> 16U) & mask;
    const std::uint32_t y = (v_level >> 16U) & mask;
    const std::uint32_t cell =
        cells[static_cast<std::int32_t>(first_cell(level) + (y << bits) + x)];
    const std::uint32_t left = (cell & 0xffU) | ((cell & 0xff00U) << 8U);
    const std::uint32_t right = ((cell >> 16U) & 0xffU) | ((cell >> 24U) << 16U);
    const std::uint32_t fu = (u_level >> 8U) & 255U;
    const std::uint32_t fv = (v_level >> 8U) & 255U;
    const std::uint32_t both = left * (256U - fu) + right * fu;
    return (both & 0xffffU) * (256U - fv) + (both >> 16U) * fv;
}

/// The two mip levels that a value uses, and the weight of the coarse one.
struct Levels {
    std::uint32_t fine = 0;
    std::uint32_t coarse = 0;
    float share = 0.0F;
};

inline Levels levels_of(float level) noexcept {
    // max() gives 0 for NaN.
    const float clamped = std::min(std::max(0.0F, level), static_cast<float>(kTopLevel));
    const int fine = static_cast<int>(clamped);  // in range: 0 to kTopLevel
    return {static_cast<std::uint32_t>(fine),
            static_cast<std::uint32_t>(std::min(fine + 1, kTopLevel)),
            clamped - static_cast<float>(fine)};
}

/// Pattern value in [-1, 1] from the sums of `taps` look-ups in both levels.
inline float pattern_value(std::uint32_t fine_sum,
                           std::uint32_t coarse_sum,
                           float share,
                           int taps) noexcept {
    const float unit = 1.0F / (65536.0F * static_cast<float>(taps));
    const float fine = static_cast<float>(static_cast<std::int32_t>(fine_sum)) * unit;
    const float coarse = static_cast<float>(static_cast<std::int32_t>(coarse_sum)) * unit;
    return (fine + share * (coarse - fine) - kMiddle) * kQuantum;
}

/// Sampling of the pixel ellipse: `taps` look-ups along its long axis.
struct Cover {
    int taps = 1;
    float level = 0.0F;
    float blotch_level = 0.0F;
    TextureTable::Place du = 0;  ///< step from tap to tap
    TextureTable::Place dv = 0;
};

inline Cover cover_of(float along_u, float along_v, float minor_texel, float cosine) noexcept {
    Cover cover;
    // The number of taps is the aspect ratio of the footprint, rounded, from 1 to 4.
    cover.taps = 1 + (cosine < 2.0F / 3.0F ? 1 : 0) + (cosine < 2.0F / 5.0F ? 1 : 0) +
                 (cosine < 2.0F / 7.0F ? 1 : 0);
    const float major_texel = minor_texel / cosine;
    const float step_texel = major_texel / static_cast<float>(cover.taps);
    cover.level = fast_log2(std::max(minor_texel, step_texel));
    cover.blotch_level =
        std::max(fast_log2(major_texel * static_cast<float>(kBlotchScale)), kBlotchLeastLevel);
    // Beyond the tile size all positions look alike.
    constexpr float kTile = TextureTable::kSize;
    const float length = std::max(std::sqrt(along_u * along_u + along_v * along_v), 1e-30F);
    const float step = std::min(step_texel, kTile) / length * 65536.0F;
    // in range: both are at most `length`, so at most a tile, 2^26
    cover.du = static_cast<TextureTable::Place>(static_cast<std::int32_t>(along_u * step));
    cover.dv = static_cast<TextureTable::Place>(
        static_cast<std::int32_t>(along_v * step));  // in range: same limit as du
    return cover;
}

/// Position of the first of `taps` look-ups that are centred on `middle`.
inline TextureTable::Place first_tap(TextureTable::Place middle,
                                     TextureTable::Place step,
                                     int taps) noexcept {
    // in range: a conversion from unsigned to signed keeps all bits
    const std::int32_t way = (taps - 1) * static_cast<std::int32_t>(step);
    return middle - static_cast<TextureTable::Place>(way >> 1);
}

inline float reflectance(float albedo, float contrast, float detail, float blotch) noexcept {
    const float value = detail + kBlotchWeight * blotch;
    return std::clamp(albedo * (1.0F + contrast * value), 0.0F, 1.0F);
}

}  // namespace surefoot::sim::lookup
