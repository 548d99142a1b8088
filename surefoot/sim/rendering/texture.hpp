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

/// Kinds of surface pattern. A carpet has a strong texture, which is easy to match and to track; a
/// painted wall (`white_wall`) has nearly none.
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

/// How a surface returns light: matte scatters it; a mirror reflects the scene; glass shows the
/// scene behind it and a weak reflection.
enum class Finish : std::uint8_t { matte, mirror, glass };
inline constexpr const char* kFinishNames[] = {"matte", "mirror", "glass"};

/// Share of a material's contrast that its pattern shows: 1, but 0.05 for `white_wall` (a contrast
/// of 0.6 leaves 1.2 % rms). ASSUMPTION: no wall was measured.
[[nodiscard]] float pattern_strength(Pattern pattern) noexcept;

/// Appearance of a surface. Reflectance = albedo (1 + contrast * pattern_strength * (pattern + 0.35
/// blotch)), clamped to [0, 1]. The pattern and its coarse blotches are in [-1, 1].
struct Material {
    Pattern pattern = Pattern::carpet;
    double albedo = 0.45;    ///< mean reflectance, 0..1
    double contrast = 0.6;   ///< contrast of the pattern; 0 = uniform
    double texel_m = 0.002;  ///< size of the finest detail of the pattern
    double yaw_rad = 0.0;    ///< rotation of the pattern on the surface
    std::uint64_t seed = 0;  ///< shifts the pattern; combined with the seed of the scene
    Finish finish = Finish::matte;
    double gloss = 0.9;  ///< mirror: share reflected; glass: share that passes straight on
    /// All solids of one shape get the same pattern. Its origin is the middle of the solid (side of
    /// a cylinder: height 0). Its shift depends on the number of the face in the solid.
    bool same_look = false;

    void describe(ConfigVisitor& visitor);
};

/// Ellipse that a pixel covers on a surface: half-power widths along its axes, and the direction of
/// the long axis in surface coordinates (unit vector).
struct Footprint {
    double minor_m = 0.0;
    double major_m = 0.0;
    double axis_u = 1.0;
    double axis_v = 0.0;
};

/// A repeating square tile of 8-bit texels with its mip levels, each half as wide (Williams 1983).
class TextureTable {
  public:
    static constexpr int kSize = 1024;
    /// Position in units of 2^-16 texels of the finest level. It wraps: adding a multiple of the
    /// tile size changes nothing.
    using Place = std::uint32_t;
    /// Converts texels. Adding `kWholeNumbers` to a double turns its lowest bits into a whole
    /// number of either sign. Wrapping is intended, and compilers vectorise this form.
    [[nodiscard]] static Place place(double texels) noexcept {
        constexpr double kWholeNumbers = 0x1.8p52;
        return static_cast<Place>(std::bit_cast<std::uint64_t>(texels * 65536.0 + kWholeNumbers));
    }

    TextureTable(Pattern pattern, std::uint64_t seed);
    /// Pattern value in [-1, 1] at a position, blurred over 2^level texels: linear in both
    /// directions and between levels (trilinear).
    [[nodiscard]] float sample(Place u, Place v, float level) const noexcept;
    /// Mean of samples at `taps` positions, 1 to 4, spaced by `du` and `dv`.
    [[nodiscard]] float mean(
        Place u, Place v, Place du, Place dv, int taps, float level) const noexcept;
    /// One texel of a level, for tests.
    [[nodiscard]] float texel(int level, int x, int y) const noexcept;
    [[nodiscard]] static constexpr int levels() noexcept { return kLevels; }
    /// Data for one bilinear look-up, packed in one word: texel (x, y) in the lowest byte, then (x,
    /// y + 1), (x + 1, y), (x + 1, y + 1), each stored as pattern value * 127 + 127. Rows of level
    /// 0 come first, then those of the next level, and so on.
    [[nodiscard]] const std::uint32_t* cells() const noexcept { return cells_.data(); }

  private:
    static constexpr int kLevels = 11;

    std::vector<std::uint32_t> cells_;
};

/// How a material lies on one surface; computed once per surface.
struct Placement {
    std::size_t table = 0;
    float albedo = 0.0F;
    float contrast = 0.0F;  ///< contrast of the material times the strength of its pattern
    double texels_per_m = 0.0;
    double along = 0.0;   ///< texels per metre times the cosine of the rotation
    double across = 0.0;  ///< texels per metre times the sine of the rotation
    double u_texel = 0.0;
    double v_texel = 0.0;
};

/// Scale of coarse blotches, much larger than the finest detail, that hide the tile repetition.
inline constexpr double kBlotchScale = 1.0 / 13.7;

/// Footprint of a pixel on a pattern, in texels: an ellipse `minor_texel` across, stretched by 1 /
/// `cosine` along a direction. The length of the direction does not matter.
struct TexelLook {
    Eigen::Vector2d at_texel;
    Eigen::Vector2f along_texel;
    float minor_texel = 0.0F;
    float cosine = 1.0F;
};

/// Positions on one surface that are looked up together, each with its pixel footprint, as for
/// Textures::reflectance.
struct TextureBatch {
    static constexpr std::size_t kMost = 256;
    template <typename T>
    using Array = std::array<T, kMost>;

    std::size_t count = 0;
    Array<TextureTable::Place> u;
    Array<TextureTable::Place> v;
    Array<TextureTable::Place> blotch_u;  ///< the same positions on the scale of the blotches
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

/// The textures of a scene. Far and grazing surfaces are averaged over the pixel footprint with up
/// to four samples along its long axis. The mip level fits the short axis or the sample spacing.
class Textures {
  public:
    Textures(const std::vector<Material>& materials, std::uint64_t seed);
    /// `surface` shifts the pattern, so that faces of one material differ.
    [[nodiscard]] Placement place(int material, int surface) const noexcept;
    /// Reflectance in [0, 1] at surface coordinates.
    [[nodiscard]] float reflectance(const Placement& placement,
                                    double u_m,
                                    double v_m,
                                    const Footprint& footprint) const noexcept;
    /// Reflectance in [0, 1] at a position in texels.
    [[nodiscard]] float reflectance(const Placement& placement,
                                    const TexelLook& look) const noexcept;
    /// Converts surface coordinates and a footprint from metres to texels.
    [[nodiscard]] static TexelLook look(const Placement& placement,
                                        double u_m,
                                        double v_m,
                                        const Footprint& footprint) noexcept;
    /// Computes `reflectance` for a batch of positions, bit-identical on every processor; `out`
    /// must have room for all of them.
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
