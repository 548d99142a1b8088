// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/sim/rendering/plane_look.hpp"
#include "surefoot/sim/rendering/texture.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// Light from the surface point that a ray hits. Radiance 1 = a fully lit white surface. `key`
/// tells faces, light and shadow, and objects in a mirror or behind a pane apart, but not textures.
struct Seen {
    float radiance = 0.0F;
    std::uint32_t key = 0;
};

/// Light from the surfaces of a scene: texture, lamp with hard shadows and stripes, mirrors and
/// panes. Recursion stops after two mirrors or panes: the next one appears matte. Panes are thin
/// (no refraction) and cast no shadow. Immutable after construction.
class Shader {
  public:
    /// The scene must outlive the shader. The seed shifts the textures.
    Shader(const Scene& scene, std::uint64_t seed);

    /// Light from a hit point of a surface.
    [[nodiscard]] Seen surface(int surface, const Sight& sight) const;
    /// Bit-identical and faster for several points of one surface; requires at least one point.
    void surface(int surface, const SightBatch& sights, std::span<Seen> out) const;
    /// Light of a ray that hits no surface.
    [[nodiscard]] static Seen background() noexcept;
    /// Returns true if the lamp lights a surface point. Always true in a scene without shadows.
    [[nodiscard]] bool lit(const Eigen::Vector3d& point_m) const;

  private:
    struct Face {
        Placement placement;
        Eigen::Vector3d normal;
        Eigen::Vector3d tangent_u;
        Eigen::Vector3d tangent_v;
        PlaneTexels texels;  ///< used only if the surface is a plane
        Finish finish = Finish::matte;
        bool curved = false;
        float gloss = 0.0F;
        double facing_lamp = 0.0;  ///< used only for a plane: cosine of the lamp's incidence
    };
    struct Blocker {
        int primitive = 0;
        Sphere bounds;
    };

    void add_face(const Surface& surface, const Material& material);
    [[nodiscard]] Seen seen(int surface, const Sight& sight, int bounces) const;
    [[nodiscard]] Seen matte(int surface, const Sight& sight) const;
    [[nodiscard]] Seen lit_surface(int surface,
                                   const Sight& sight,
                                   double facing_lamp,
                                   float albedo,
                                   std::span<const Blocker> blockers) const;
    [[nodiscard]] bool lit(const Eigen::Vector3d& point_m, std::span<const Blocker> blockers) const;
    [[nodiscard]] bool may_shade(const Sphere& blocker, const Sphere& points) const;
    [[nodiscard]] std::vector<Blocker> blockers_of(const Face& face,
                                                   const SightBatch& sights) const;
    void plane(int surface, const SightBatch& sights, std::span<Seen> out) const;
    void curved(int surface, const SightBatch& sights, std::span<Seen> out) const;
    [[nodiscard]] Seen along(const Sight& sight, int bounces) const;
    [[nodiscard]] SurfacePoint point_on(int surface, const Eigen::Vector3d& point_m) const;
    [[nodiscard]] double stripes(const Sight& sight, const SurfacePoint& at) const;

    const Scene* scene_;
    Lighting lighting_;
    Textures textures_;
    std::vector<Face> faces_;
    Eigen::Vector3d towards_lamp_;
    Eigen::Vector3d across_stripes_;
    std::vector<Blocker> blockers_;
    double lamp_plane_m_ = 0.0;  ///< plane across `towards_lamp_`; the whole scene is behind it
};

}  // namespace surefoot::sim
