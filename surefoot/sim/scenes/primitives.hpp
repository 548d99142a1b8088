// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "surefoot/sim/rendering/beam.hpp"
#include "surefoot/sim/rendering/ray_batch.hpp"

namespace surefoot::sim {

/// Intersection of a vertical line with one primitive: solid from `bottom_m` up to `top_m`. For a
/// sheet (a floor) both are equal. `face` is the index within the primitive.
struct Column {
    double bottom_m = 0.0;
    double top_m = 0.0;
    int face = 0;
};

/// Frame of a face for shading and texture. Surface coordinates of a point p are (p . tangent_u, p
/// . tangent_v) in metres; on the side of a cylinder (arc length, height).
struct FaceFrame {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward
    Eigen::Vector3d tangent_u = Eigen::Vector3d::UnitX();
    Eigen::Vector3d tangent_v = Eigen::Vector3d::UnitY();
    bool curved = false;                               ///< side of a cylinder
    Eigen::Vector2d axis_m = Eigen::Vector2d::Zero();  ///< axis of that cylinder
    double radius_m = 0.0;                             ///< radius of that cylinder
};

/// The plane of a face: normal . p = offset_m. `face` is the index within the primitive.
struct FacePlane {
    int face = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset_m = 0.0;
};

/// Axis-parallel rectangle on the ground plane.
struct Rect {
    Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
};

/// A rectangular hole in a floor with vertical walls and a flat bottom.
struct Pit {
    Rect area;
    double depth_m = 0.0;
};

/// Horizontal sheet with pits, visible from above only. Face 0 is the floor; pit k has its bottom
/// at face 1 + 5k, then the walls at -x, +x, -y, +y. The rim belongs to the floor.
class Floor {
  public:
    Floor(const Rect& area, double z_m, std::vector<Pit> pits = {});

    void intersect(const Eigen::Vector3d& origin,
                   std::span<const Eigen::Vector3d> directions,
                   int first_face,
                   std::span<RayHit> hits) const;
    void intersect(const Eigen::Vector3d& origin,
                   const RayBatch& rays,
                   BatchRange range,
                   int first_face,
                   HitBatch& hits) const;
    [[nodiscard]] std::optional<Column> column(double x_m, double y_m) const;
    [[nodiscard]] std::optional<double> highest_over(const Rect& cell) const;
    [[nodiscard]] Sphere bounds() const;
    [[nodiscard]] std::vector<Eigen::Vector3d> hull() const;
    [[nodiscard]] std::optional<FacePlane> only_face(const Beam& beam) const;
    [[nodiscard]] std::vector<FaceFrame> faces() const;
    [[nodiscard]] int pits() const noexcept { return static_cast<int>(pits_.size()); }

  private:
    void enter_pit(int pit,
                   const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& direction,
                   int first_face,
                   RayHit& hit) const;

    Rect area_;
    double z_m_ = 0.0;
    std::vector<Pit> pits_;
};

/// Convex footprint with vertical sides, a flat bottom and a plane top: boxes, stair treads, ramps,
/// steps of a spiral flight. Face 0 is the top, 1 the bottom, 2 + k the side at footprint edge k.
class Prism {
  public:
    /// Top plane z = top_m + slope . (p_xy - reference_m).
    struct Top {
        double top_m = 0.0;
        Eigen::Vector2d slope = Eigen::Vector2d::Zero();
        Eigen::Vector2d reference_m = Eigen::Vector2d::Zero();
    };
    /// `footprint_m` counter-clockwise, at least 3 corners.
    Prism(std::vector<Eigen::Vector2d> footprint_m, double bottom_m, const Top& top);

    void intersect(const Eigen::Vector3d& origin,
                   std::span<const Eigen::Vector3d> directions,
                   int first_face,
                   std::span<RayHit> hits) const;
    void intersect(const Eigen::Vector3d& origin,
                   const RayBatch& rays,
                   BatchRange range,
                   int first_face,
                   HitBatch& hits) const;
    [[nodiscard]] std::optional<Column> column(double x_m, double y_m) const;
    [[nodiscard]] std::optional<double> highest_over(const Rect& cell) const;
    [[nodiscard]] Sphere bounds() const;
    [[nodiscard]] std::vector<Eigen::Vector3d> hull() const;
    [[nodiscard]] std::optional<FacePlane> only_face(const Beam& beam) const;
    [[nodiscard]] std::vector<FaceFrame> faces() const;

  private:
    struct HalfSpace {
        Eigen::Vector3d normal;
        double offset_m;  ///< inside: normal . p <= offset
    };
    static constexpr std::size_t kMaxFaces = 16;
    /// Sides of the solid relative to a ray origin; the sides that face the origin come first.
    struct Facing {
        std::array<FacingSide, kMaxFaces> sides;
        std::size_t towards = 0;
    };
    [[nodiscard]] Facing facing(const Eigen::Vector3d& origin, int first_face) const;
    [[nodiscard]] double top_at(const Eigen::Vector2d& p_m) const;

    std::vector<Eigen::Vector2d> footprint_m_;
    double bottom_m_ = 0.0;
    Top top_;
    std::vector<HalfSpace> half_spaces_;                    ///< indexed like the faces
    std::vector<std::vector<Eigen::Vector3d>> polygons_m_;  ///< face corners, counter-clockwise
};

/// Upright cylinder. Face 0 is the top, 1 the bottom, 2 the side.
class Cylinder {
  public:
    Cylinder(const Eigen::Vector2d& center_m, double radius_m, double bottom_m, double top_m);

    void intersect(const Eigen::Vector3d& origin,
                   std::span<const Eigen::Vector3d> directions,
                   int first_face,
                   std::span<RayHit> hits) const;
    void intersect(const Eigen::Vector3d& origin,
                   const RayBatch& rays,
                   BatchRange range,
                   int first_face,
                   HitBatch& hits) const;
    [[nodiscard]] std::optional<Column> column(double x_m, double y_m) const;
    [[nodiscard]] std::optional<double> highest_over(const Rect& cell) const;
    [[nodiscard]] Sphere bounds() const;
    [[nodiscard]] std::vector<Eigen::Vector3d> hull() const;
    [[nodiscard]] std::optional<FacePlane> only_face(const Beam& beam) const;
    [[nodiscard]] std::vector<FaceFrame> faces() const;

  private:
    Eigen::Vector2d center_m_;
    double radius_m_ = 0.0;
    double bottom_m_ = 0.0;
    double top_m_ = 0.0;
};

/// Every primitive offers
///   intersect       shortens `hits` of rays that meet it at a distance > 0 (unit directions; a
///                   NaN ray misses). A batch gives the same bits as single rays.
///   column          the part of a vertical line that is solid, border included
///   highest_over    exact highest point over the inside of a cell
///   hull            corners of a convex solid that contains the primitive
///   only_face       the plane face that every ray of a beam meets first, if the proof is easy;
///                   `intersect` then gives the distance to its plane, to the last bit
using Primitive = std::variant<Floor, Prism, Cylinder>;

/// Box that stands at `center_m`, turned by `yaw_rad` about its upright axis.
[[nodiscard]] Prism make_box(const Eigen::Vector2d& center_m,
                             const Eigen::Vector2d& size_m,
                             double bottom_m,
                             double top_m,
                             double yaw_rad = 0.0);

/// Wedge that begins at the middle of its low edge `foot_m` and climbs `rise_m` along `yaw_rad`.
[[nodiscard]] Prism make_ramp(const Eigen::Vector2d& foot_m,
                              double length_m,
                              double width_m,
                              double bottom_m,
                              double rise_m,
                              double yaw_rad = 0.0);

}  // namespace surefoot::sim
