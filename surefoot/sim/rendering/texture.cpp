// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/rendering/texture_lookup.hpp"
#include "surefoot/sim/rendering/texture_patterns.hpp"

namespace surefoot::sim {
namespace {

/// Appends the cells of one level; the level repeats beyond its border.
void append_cells(const Image<float>& field, std::vector<std::uint32_t>& cells) {
    const int mask = field.width() - 1;
    const auto stored = [&](int x, int y) {
        const float value = field.at(x & mask, y & mask);
        return std::uint32_t{
            saturated_integer<std::uint8_t>(std::round(value * lookup::kMiddle + lookup::kMiddle))};
    };
    for (int y = 0; y <= mask; ++y) {
        std::uint32_t left = stored(0, y) | (stored(0, y + 1) << 8U);
        for (int x = 0; x <= mask; ++x) {
            const std::uint32_t right = stored(x + 1, y) | (stored(x + 1, y + 1) << 8U);
            cells.push_back(left | (right << 16U));
            left = right;
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
    visitor.enumeration("pattern", pattern, kPatternNames, "pattern of the surface");
    visitor.number("albedo", albedo, 0.0, 1.0, "mean reflectance of the surface");
    visitor.number("contrast", contrast, 0.0, 1.0, "contrast of the pattern; 0 = uniform");
    visitor.number("texel_m", texel_m, 1e-4, 0.1, "size of the finest detail of the pattern");
    visitor.number("yaw_rad", yaw_rad, -10.0, 10.0, "rotation of the pattern on the surface");
    visitor.enumeration(
        "finish", finish, kFinishNames, "how the surface reflects or transmits light");
    visitor.number(
        "gloss",
        gloss,
        0.0,
        1.0,
        "share of light that a mirror reflects or glass transmits; not used if finish is matte");
    visitor.boolean("same_look",
                    same_look,
                    "true: all solids of this material and of one shape have the same pattern");
}

TextureTable::TextureTable(Pattern pattern, std::uint64_t seed) {
    static_assert(kSize == 1 << (kLevels - 1));
    Image<float> field = draw_pattern(pattern, kSize, seed);
    cells_.reserve(lookup::first_cell(kLevels));
    for (int level = 0; level < kLevels; ++level) {
        append_cells(field, cells_);
        if (field.width() > 1) field = halved(field);
    }
}

float TextureTable::texel(int level, int x, int y) const noexcept {
    const int mask = (kSize >> level) - 1;
    const int index = (y & mask) * (mask + 1) + (x & mask);
    const std::uint32_t cell = cells_[lookup::first_cell(static_cast<std::uint32_t>(level)) +
                                      static_cast<std::size_t>(index)];
    return (static_cast<float>(cell & 0xffU) - lookup::kMiddle) * lookup::kQuantum;
}

float TextureTable::sample(Place u, Place v, float level) const noexcept {
    return mean(u, v, 0, 0, 1, level);
}

float TextureTable::mean(
    Place u, Place v, Place du, Place dv, int taps, float level) const noexcept {
    const lookup::Levels levels = lookup::levels_of(level);
    std::uint32_t fine_sum = 0;
    std::uint32_t coarse_sum = 0;
    for (int tap = 0; tap < taps; ++tap, u += du, v += dv) {
        fine_sum += lookup::bilinear(cells(), levels.fine, u, v);
        coarse_sum += lookup::bilinear(cells(), levels.coarse, u, v);
    }
    return lookup::pattern_value(fine_sum, coarse_sum, levels.share, taps);
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
    return reflectance(placement, look(placement, u_m, v_m, footprint));
}

TexelLook Textures::look(const Placement& placement,
                         double u_m,
                         double v_m,
                         const Footprint& footprint) noexcept {
    const Eigen::Vector2d along(
        placement.along * footprint.axis_u + placement.across * footprint.axis_v,
        placement.along * footprint.axis_v - placement.across * footprint.axis_u);
    TexelLook look;
    look.at_texel = {placement.along * u_m + placement.across * v_m + placement.u_texel,
                     placement.along * v_m - placement.across * u_m + placement.v_texel};
    look.along_texel = along.cast<float>();
    look.minor_texel = static_cast<float>(footprint.minor_m * placement.texels_per_m);
    look.cosine = static_cast<float>(footprint.minor_m / footprint.major_m);
    return look;
}

float Textures::reflectance(const Placement& placement, const TexelLook& look) const noexcept {
    const TextureTable& table = tables_[placement.table];
    const lookup::Cover cover =
        lookup::cover_of(look.along_texel.x(), look.along_texel.y(), look.minor_texel, look.cosine);
    const auto u = TextureTable::place(look.at_texel.x());
    const auto v = TextureTable::place(look.at_texel.y());
    const float detail = table.mean(lookup::first_tap(u, cover.du, cover.taps),
                                    lookup::first_tap(v, cover.dv, cover.taps),
                                    cover.du,
                                    cover.dv,
                                    cover.taps,
                                    cover.level);
    const float blotch = table.sample(TextureTable::place(look.at_texel.x() * kBlotchScale),
                                      TextureTable::place(look.at_texel.y() * kBlotchScale),
                                      cover.blotch_level);
    return lookup::reflectance(placement.albedo, placement.contrast, detail, blotch);
}

}  // namespace surefoot::sim
