// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/sim/rendering/lighting.hpp"
#include "surefoot/sim/rendering/texture.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {

/// Class of a surface, for ground truth.
enum class Label : std::uint8_t {
    none,
    floor,
    step,
    ramp,
    table,
    drop,
    wall,
    object,
    kerb,
    sill,
    door,
    overhang
};
inline constexpr const char* kLabelNames[] = {"none",
                                              "floor",
                                              "step",
                                              "ramp",
                                              "table",
                                              "drop",
                                              "wall",
                                              "object",
                                              "kerb",
                                              "sill",
                                              "door",
                                              "overhang"};
[[nodiscard]] const char* to_string(Label label) noexcept;

/// A face of a primitive; its index counts the faces of all primitives of the scene.
struct Surface {
    FaceFrame frame;
    int primitive = 0;
    int material = 0;
    Label label = Label::none;
};

/// Geometry at a point of a surface: outward normal, tangents, surface coordinates.
struct SurfacePoint {
    Eigen::Vector3d normal;
    Eigen::Vector3d tangent_u;
    Eigen::Vector3d tangent_v;
    double u_m = 0.0;
    double v_m = 0.0;
};

struct Hit {
    double distance_m = 0.0;
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    int surface = 0;
    SurfacePoint at;
};

/// Point where a vertical line meets an upward surface.
struct SurfaceHeight {
    double z_m = 0.0;
    int surface = 0;
};

/// Analytic primitives in the world frame (x forward, z up, metres). Rays, heights and height maps
/// use the same exact geometry, so that a rendered image agrees with its ground truth.
class Scene {
  public:
    /// Returns the material index for `add`.
    int add_material(const Material& material);
    void add(Primitive primitive, int material, Label label);
    /// Bottoms and walls of pits get the label drop and `pit_material`.
    void add_floor(const Floor& floor, int material, int pit_material, Label label = Label::floor);

    void light(const Lighting& lighting) { lighting_ = lighting; }
    void scale_contrast(double factor) {
        for (Material& material : materials_) material.contrast *= factor;
    }
    [[nodiscard]] const Lighting& lighting() const noexcept { return lighting_; }

    /// First surface along a ray (unit direction); only faces that point toward the origin count.
    [[nodiscard]] std::optional<Hit> intersect(const Eigen::Vector3d& origin_m,
                                               const Eigen::Vector3d& direction) const;
    /// Returns true if the ray hits a surface nearer than `distance_m`.
    [[nodiscard]] bool blocked(const Eigen::Vector3d& origin_m,
                               const Eigen::Vector3d& direction,
                               double distance_m) const;
    /// Shortens `hits` where one primitive is nearer; the inner loop of the renderer.
    void intersect_primitive(int primitive,
                             const Eigen::Vector3d& origin_m,
                             std::span<const Eigen::Vector3d> directions,
                             std::span<RayHit> hits) const;
    void intersect_primitive(int primitive,
                             const Eigen::Vector3d& origin_m,
                             const RayBatch& rays,
                             BatchRange range,
                             HitBatch& hits) const;
    [[nodiscard]] SurfacePoint surface_point(int surface, const Eigen::Vector3d& point_m) const;

    /// Highest surface at a point; no value without ground.
    [[nodiscard]] std::optional<SurfaceHeight> height_at(double x_m, double y_m) const;
    /// Every upward surface that is not buried in another solid, highest first (a table, then the
    /// floor under it).
    [[nodiscard]] std::vector<SurfaceHeight> surfaces_at(double x_m, double y_m) const;
    /// Index of the first primitive that contains a point; its surface counts.
    [[nodiscard]] std::optional<int> solid_at(const Eigen::Vector3d& point_m) const;
    /// Exact highest point over the inside of a cell; no value without ground.
    [[nodiscard]] std::optional<double> highest_over(const Rect& cell) const;

    [[nodiscard]] int primitives() const noexcept { return static_cast<int>(primitives_.size()); }
    [[nodiscard]] const Primitive& primitive(int index) const;
    [[nodiscard]] const Sphere& bounds(int primitive) const;
    [[nodiscard]] const std::vector<Eigen::Vector3d>& hull(int primitive) const;
    /// Calls `only_face` of one primitive; the face index is that of the scene.
    [[nodiscard]] std::optional<FacePlane> only_face(int primitive, const Beam& beam) const;
    /// Index of the first surface of a primitive; its other surfaces follow.
    [[nodiscard]] int first_surface(int primitive) const {
        return first_surface_[static_cast<std::size_t>(primitive)];
    }
    [[nodiscard]] const std::vector<Surface>& surfaces() const noexcept { return surfaces_; }
    [[nodiscard]] const std::vector<Material>& materials() const noexcept { return materials_; }

  private:
    std::vector<Primitive> primitives_;
    std::vector<int> first_surface_;
    std::vector<Sphere> bounds_;
    std::vector<std::vector<Eigen::Vector3d>> hulls_;
    std::vector<Surface> surfaces_;
    std::vector<Material> materials_;
    Lighting lighting_;
};

}  // namespace surefoot::sim
