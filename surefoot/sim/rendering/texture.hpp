// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// Kinds of surface, from a carpet full of structure, as matchers and trackers need it, to a
/// painted wall that has nearly none.
enum class Pattern : std::uint8_t {
    carpet,
    tiles,
    wood,
    concrete,
    patches,
    plaster,
    white_wall,
    terrazzo,
    asphalt,
    gravel,
    grass
};
inline constexpr int kPatterns = 11;
inline constexpr const char* kPatternNames[kPatterns] = {"carpet",
                                                         "tiles",
                                                         "wood",
                                                         "concrete",
                                                         "patches",
                                                         "plaster",
                                                         "white_wall",
                                                         "terrazzo",
                                                         "asphalt",
                                                         "gravel",
                                                         "grass"};
[[nodiscard]] const char* to_string(Pattern pattern) noexcept;

/// What happens to light at a surface: matte scatters it; a mirror shows the scene that it
/// reflects; glass shows what is behind it and a little of what it reflects.
enum class Finish : std::uint8_t { matte, mirror, glass };
inline constexpr const char* kFinishNames[] = {"matte", "mirror", "glass"};

/// Share of a material's contrast that its pattern shows: paint from a roller hides nearly all of
/// it (a contrast of 0.6 leaves 1.2 % rms). ASSUMPTION: no wall was measured.
[[nodiscard]] float pattern_strength(Pattern pattern) noexcept;

/// How a surface looks. Reflectance = albedo (1 + contrast * strength * pattern), pattern in
/// [-1, 1].
struct Material {
    Pattern pattern = Pattern::carpet;
    double albedo = 0.45;    ///< mean reflectance, 0..1
    double contrast = 0.6;   ///< 0 = uniform
    double texel_m = 0.002;  ///< size of the finest detail
    double yaw_rad = 0.0;    ///< turn of the pattern on the surface
    std::uint64_t seed = 0;  ///< shifts the pattern; mixed with the seed of the scene
    Finish finish = Finish::matte;
    double gloss = 0.9;  ///< mirror: share reflected; glass: share that passes straight on
    /// Solids of one shape look alike: the pattern counts from the middle of the solid (around a
    /// cylinder from height 0) and its shift is that of the face within the solid.
    bool same_look = false;

    void describe(ConfigVisitor& visitor);
};

/// Ellipse that a pixel covers on a surface: half-power widths along its axes, and the direction of
/// the long one in surface coordinates (unit vector).
struct Footprint {
    double minor_m = 0.0;
    double major_m = 0.0;
    double axis_u = 1.0;
    double axis_v = 0.0;
};

/// A square tile of 8-bit texels that repeats, with all its halvings (mip levels, Williams 1983).
class TextureTable {
  public:
    static constexpr int kSize = 1024;
    /// Places are counted in 2^-16 of a texel of the finest level; they wrap with the tile, so any
    /// multiple of the tile may be added or lost.
    using Place = std::uint32_t;
    /// Added to a double this makes its lowest bits a whole number, whatever its sign: what wraps
    /// is wanted, and compilers do it for many places at once.
    [[nodiscard]] static Place place(double texels) noexcept {
        constexpr double kWholeNumbers = 0x1.8p52;
        return static_cast<Place>(std::bit_cast<std::uint64_t>(texels * 65536.0 + kWholeNumbers));
    }

    TextureTable(Pattern pattern, std::uint64_t seed);
    /// Pattern value in [-1, 1] at a place, blurred over 2^level texels: linear in both directions
    /// and between levels (trilinear).
    [[nodiscard]] float sample(Place u, Place v, float level) const noexcept;
    /// Mean of samples at `taps` places, 1 to 4, `du` and `dv` from each other.
    [[nodiscard]] float mean(
        Place u, Place v, Place du, Place dv, int taps, float level) const noexcept;
    /// A texel of a level, for tests.
    [[nodiscard]] float texel(int level, int x, int y) const noexcept;
    [[nodiscard]] static constexpr int levels() noexcept { return kLevels; }
    /// What one look-up between four texels needs, in one word: the texel (x, y) in the lowest
    /// byte, then (x, y + 1), (x + 1, y), (x + 1, y + 1), each pattern value * 127 + 127. Rows of
    /// level 0, then those of the next level, and so on.
    [[nodiscard]] const std::uint32_t* cells() const noexcept { return cells_.data(); }

  private:
    static constexpr int kLevels = 11;

    std::vector<std::uint32_t> cells_;
};

/// How a material lies on one surface; made once a surface.
struct Placement {
    std::size_t table = 0;
    float albedo = 0.0F;
    float contrast = 0.0F;  ///< of the material times the strength of its pattern
    double texels_per_m = 0.0;
    double along = 0.0;   ///< texels a metre times the cosine of the turn
    double across = 0.0;  ///< texels a metre times its sine
    double u_texel = 0.0;
    double v_texel = 0.0;
};

/// Coarse blotches, many times the finest detail in size, hide that the tile repeats.
inline constexpr double kBlotchScale = 1.0 / 13.7;

/// The footprint of a pixel on a pattern, in texels: an ellipse `minor_texel` across, stretched by
/// 1 / `cosine` along a direction of any length.
struct TexelLook {
    Eigen::Vector2d at_texel;
    Eigen::Vector2f along_texel;
    float minor_texel = 0.0F;
    float cosine = 1.0F;
};

/// Places on one surface that are looked up together, each with the footprint of its pixel as for
/// Textures::reflectance.
struct TextureBatch {
    static constexpr std::size_t kMost = 256;
    template <typename T>
    using Array = std::array<T, kMost>;

    std::size_t count = 0;
    Array<TextureTable::Place> u;
    Array<TextureTable::Place> v;
    Array<TextureTable::Place> blotch_u;  ///< the same places on the scale of the blotches
    Array<TextureTable::Place> blotch_v;
    Array<float> along_u;
    Array<float> along_v;
    Array<float> minor_texel;
    Array<float> cosine;

    void add(const TexelLook& look) {
        u[count] = TextureTable::place(look.at_texel.x());
        v[count] = TextureTable::place(look.at_texel.y());
        blotch_u[count] = TextureTable::place(look.at_texel.x() * kBlotchScale);
        blotch_v[count] = TextureTable::place(look.at_texel.y() * kBlotchScale);
        along_u[count] = look.along_texel.x();
        along_v[count] = look.along_texel.y();
        minor_texel[count] = look.minor_texel;
        cosine[count] = look.cosine;
        ++count;
    }
};

/// The textures of a scene. Far and grazing surfaces are averaged over the pixel's footprint: up to
/// four samples along its long axis, each from the mip level that fits the short one.
class Textures {
  public:
    Textures(const std::vector<Material>& materials, std::uint64_t seed);
    /// `surface` shifts the pattern so that faces of one material differ.
    [[nodiscard]] Placement place(int material, int surface) const noexcept;
    /// Reflectance in [0, 1] at surface coordinates.
    [[nodiscard]] float reflectance(const Placement& placement,
                                    double u_m,
                                    double v_m,
                                    const Footprint& footprint) const noexcept;
    /// The same in texels.
    [[nodiscard]] float reflectance(const Placement& placement,
                                    const TexelLook& look) const noexcept;
    /// Surface coordinates and a footprint in metres, in texels.
    [[nodiscard]] static TexelLook look(const Placement& placement,
                                        double u_m,
                                        double v_m,
                                        const Footprint& footprint) noexcept;
    /// The same, bit by bit and on every processor, for a batch of places; `out` has room for all
    /// of them.
    void reflectances(const Placement& placement,
                      const TextureBatch& batch,
                      float* out) const noexcept;

  private:
    struct Known {
        Material material;
        std::size_t table = 0;
        std::uint64_t seed = 0;
    };
    std::vector<Known> materials_;
    std::vector<TextureTable> tables_;
};

}  // namespace surefoot::sim
