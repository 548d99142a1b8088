// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// Kinds of surface. Each has structure from millimetres to metres, as matchers and trackers need.
enum class Pattern : std::uint8_t { carpet, tiles, wood, concrete, patches, plaster };
inline constexpr int kPatterns = 6;
inline constexpr const char* kPatternNames[kPatterns] = {
    "carpet", "tiles", "wood", "concrete", "patches", "plaster"};
[[nodiscard]] const char* to_string(Pattern pattern) noexcept;

/// What happens to light at a surface: matte scatters it; a mirror shows the scene that it
/// reflects; glass shows what is behind it and a little of what it reflects.
enum class Finish : std::uint8_t { matte, mirror, glass };
inline constexpr const char* kFinishNames[] = {"matte", "mirror", "glass"};

/// How a surface looks. Reflectance = albedo (1 + contrast * pattern), pattern in [-1, 1].
struct Material {
    Pattern pattern = Pattern::carpet;
    double albedo = 0.45;    ///< mean reflectance, 0..1
    double contrast = 0.6;   ///< 0 = uniform
    double texel_m = 0.002;  ///< size of the finest detail
    double yaw_rad = 0.0;    ///< turn of the pattern on the surface
    std::uint64_t seed = 0;  ///< shifts the pattern; mixed with the seed of the scene
    Finish finish = Finish::matte;
    double gloss = 0.9;  ///< mirror: share reflected; glass: share that passes straight on

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

    TextureTable(Pattern pattern, std::uint64_t seed);
    /// Pattern value in [-1, 1] at a place in texels (>= 0) of the finest level, blurred over
    /// 2^level texels: linear in both directions and between levels (trilinear).
    [[nodiscard]] float sample(double u_texel, double v_texel, float level) const noexcept;
    /// A texel of a level, for tests.
    [[nodiscard]] float texel(int level, int x, int y) const noexcept;
    [[nodiscard]] int levels() const noexcept { return static_cast<int>(levels_.size()); }

  private:
    [[nodiscard]] float bilinear(int level, double u_texel, double v_texel) const noexcept;
    std::vector<std::vector<std::int8_t>> levels_;
};

/// The textures of a scene. Far and grazing surfaces are averaged over the pixel's footprint: up to
/// four samples along its long axis, each from the mip level that fits the short one.
class Textures {
  public:
    Textures(const std::vector<Material>& materials, std::uint64_t seed);
    /// Reflectance in [0, 1] at surface coordinates. `surface` shifts the pattern so that faces of
    /// one material differ.
    [[nodiscard]] float reflectance(int material,
                                    int surface,
                                    double u_m,
                                    double v_m,
                                    const Footprint& footprint) const noexcept;

  private:
    struct Placed {
        Material material;
        std::size_t table = 0;
        double texels_per_m = 0.0;
        double cos_yaw = 1.0;
        double sin_yaw = 0.0;
        std::uint64_t seed = 0;
    };
    std::vector<Placed> materials_;
    std::vector<TextureTable> tables_;
};

}  // namespace surefoot::sim
