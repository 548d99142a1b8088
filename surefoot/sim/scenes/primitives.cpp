// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/primitives.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Rims belong to the solid: a point outside by at most this distance still stands on the solid.
constexpr double kRim_m = 1e-9;
/// A primitive does not cover a cell that overlaps it by less than this width. This keeps the cell
/// before a riser at the height of the floor if riser and cell border coincide.
constexpr double kTouch_m = 1e-6;

bool inside(const Rect& rect, double x_m, double y_m, double margin_m) {
    return x_m >= rect.min_m.x() - margin_m && x_m <= rect.max_m.x() + margin_m &&
           y_m >= rect.min_m.y() - margin_m && y_m <= rect.max_m.y() + margin_m;
}

bool overlaps(const Rect& a, const Rect& b) {
    return a.min_m.x() < b.max_m.x() - kTouch_m && b.min_m.x() < a.max_m.x() - kTouch_m &&
           a.min_m.y() < b.max_m.y() - kTouch_m && b.min_m.y() < a.max_m.y() - kTouch_m;
}

void shorten(RayHit& hit, double distance_m, int face) {
    if (distance_m > 0.0 && distance_m < hit.distance_m) hit = {distance_m, face};
}

/// Returns the part of a polygon with normal . p <= offset (Sutherland and Hodgman 1974, one edge).
std::vector<Vector2d> clip(const std::vector<Vector2d>& polygon,
                           const Vector2d& normal,
                           double offset) {
    std::vector<Vector2d> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d& a = polygon[i];
        const Vector2d& b = polygon[(i + 1) % polygon.size()];
        const double da = normal.dot(a) - offset;
        const double db = normal.dot(b) - offset;
        if (da <= 0.0) kept.push_back(a);
        if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0))
            kept.push_back(a + da / (da - db) * (b - a));
    }
    return kept;
}

FaceFrame side_frame(const Vector3d& normal) {
    FaceFrame frame;
    frame.normal = normal;
    frame.tangent_u = Vector3d::UnitZ().cross(normal).normalized();
    frame.tangent_v = Vector3d::UnitZ();
    return frame;
}

/// Returns the corners, counter-clockwise as seen from above.
std::vector<Vector3d> corners_of(const Rect& rect, double z_m) {
    return {{rect.min_m.x(), rect.min_m.y(), z_m},
            {rect.max_m.x(), rect.min_m.y(), z_m},
            {rect.max_m.x(), rect.max_m.y(), z_m},
            {rect.min_m.x(), rect.max_m.y(), z_m}};
}

Vector2d direction(double yaw_rad) {
    return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

/// Intersects the rays one by one.
template <typename Shape>
void intersect_each(const Shape& shape,
                    const Vector3d& origin,
                    const RayBatch& rays,
                    BatchRange range,
                    int first_face,
                    HitBatch& hits) {
    for (std::size_t i = range.first; i < range.end; ++i) {
        const Vector3d direction = rays[i];
        RayHit hit = hits[i];
        shape.intersect(origin, {&direction, 1}, first_face, {&hit, 1});
        hits.set(i, hit);
    }
}

}  // namespace

Floor::Floor(const Rect& area, double z_m, std::vector<Pit> pits)
    : area_(area), z_m_(z_m), pits_(std::move(pits)) {}

void Floor::intersect(const Vector3d& origin,
                      std::span<const Vector3d> directions,
                      int first_face,
                      std::span<RayHit> hits) const {
    const double above_m = origin.z() - z_m_;
    if (!(above_m > 0.0)) return;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vector3d& d = directions[i];
        if (!(d.z() < 0.0)) continue;
        const double distance_m = -above_m / d.z();
        if (distance_m >= hits[i].distance_m) continue;
        const double x_m = origin.x() + distance_m * d.x();
        const double y_m = origin.y() + distance_m * d.y();
        if (!inside(area_, x_m, y_m, 0.0)) continue;
        const auto pit = std::find_if(pits_.begin(), pits_.end(), [&](const Pit& p) {
            return inside(p.area, x_m, y_m, -kRim_m);
        });
        if (pit == pits_.end()) {
            hits[i] = {distance_m, first_face};
        } else {
            enter_pit(static_cast<int>(pit - pits_.begin()), origin, d, first_face, hits[i]);
        }
    }
}

void Floor::intersect(const Vector3d& origin,
                      const RayBatch& rays,
                      BatchRange range,
                      int first_face,
                      HitBatch& hits) const {
    intersect_each(*this, origin, rays, range, first_face, hits);
}

/// Finds the hit of a ray inside the open box of a pit. The ray leaves the box through a wall or
/// the bottom.
void Floor::enter_pit(
    int pit, const Vector3d& origin, const Vector3d& direction, int first_face, RayHit& hit) const {
    const Pit& p = pits_[static_cast<std::size_t>(pit)];
    const int bottom_face = first_face + 1 + 5 * pit;
    double exit_m = (z_m_ - p.depth_m - origin.z()) / direction.z();
    int face = bottom_face;
    for (int axis = 0; axis < 2; ++axis) {
        if (direction[axis] == 0.0) continue;
        const bool upward = direction[axis] > 0.0;
        const double wall_m = upward ? p.area.max_m[axis] : p.area.min_m[axis];
        const double distance_m = (wall_m - origin[axis]) / direction[axis];
        if (distance_m < exit_m) {
            exit_m = distance_m;
            face = bottom_face + 1 + 2 * axis + (upward ? 1 : 0);
        }
    }
    shorten(hit, exit_m, face);
}

std::optional<Column> Floor::column(double x_m, double y_m) const {
    if (!inside(area_, x_m, y_m, kRim_m)) return std::nullopt;
    for (std::size_t k = 0; k < pits_.size(); ++k) {
        if (!inside(pits_[k].area, x_m, y_m, -kRim_m)) continue;
        const double z_m = z_m_ - pits_[k].depth_m;
        return Column{z_m, z_m, 1 + 5 * static_cast<int>(k)};
    }
    return Column{z_m_, z_m_, 0};
}

std::optional<double> Floor::highest_over(const Rect& cell) const {
    if (!overlaps(area_, cell)) return std::nullopt;
    for (const Pit& pit : pits_) {
        const bool whole = cell.min_m.x() >= pit.area.min_m.x() - kTouch_m &&
                           cell.max_m.x() <= pit.area.max_m.x() + kTouch_m &&
                           cell.min_m.y() >= pit.area.min_m.y() - kTouch_m &&
                           cell.max_m.y() <= pit.area.max_m.y() + kTouch_m;
        if (whole) return z_m_ - pit.depth_m;
    }
    return z_m_;
}

Sphere Floor::bounds() const {
    double deepest_m = 0.0;
    for (const Pit& pit : pits_) deepest_m = std::max(deepest_m, pit.depth_m);
    const Vector2d middle_m = 0.5 * (area_.min_m + area_.max_m);
    const double half_diagonal_m = 0.5 * (area_.max_m - area_.min_m).norm();
    return {{middle_m.x(), middle_m.y(), z_m_}, std::hypot(half_diagonal_m, deepest_m)};
}

std::vector<Vector3d> Floor::hull() const {
    double deepest_m = 0.0;
    for (const Pit& pit : pits_) deepest_m = std::max(deepest_m, pit.depth_m);
    std::vector<Vector3d> corners_m = corners_of(area_, z_m_);
    const std::vector<Vector3d> low_m = corners_of(area_, z_m_ - deepest_m);
    corners_m.insert(corners_m.end(), low_m.begin(), low_m.end());
    return corners_m;
}

std::optional<FacePlane> Floor::only_face(const Beam& beam) const {
    const double above_m = beam.tip_m().z() - z_m_;
    if (!(above_m > beam.tip_radius_m()) || !beam.inside(corners_of(area_, z_m_), above_m)) {
        return std::nullopt;
    }
    const bool beside_pits = std::all_of(pits_.begin(), pits_.end(), [&](const Pit& pit) {
        return beam.outside(corners_of(pit.area, z_m_), above_m);
    });
    if (!beside_pits) return std::nullopt;
    return FacePlane{0, Vector3d::UnitZ(), z_m_};
}

std::vector<FaceFrame> Floor::faces() const {
    std::vector<FaceFrame> frames(1);
    for (std::size_t k = 0; k < pits_.size(); ++k) {
        frames.emplace_back();
        // The walls of a pit face inward.
        frames.push_back(side_frame(Vector3d::UnitX()));
        frames.push_back(side_frame(-Vector3d::UnitX()));
        frames.push_back(side_frame(Vector3d::UnitY()));
        frames.push_back(side_frame(-Vector3d::UnitY()));
    }
    return frames;
}

Prism::Prism(std::vector<Vector2d> footprint_m, double bottom_m, const Top& top)
    : footprint_m_(std::move(footprint_m)), bottom_m_(bottom_m), top_(top) {
    SUREFOOT_ASSERT(footprint_m_.size() >= 3);
    const Vector3d up = Vector3d(-top_.slope.x(), -top_.slope.y(), 1.0).normalized();
    const Vector3d on_top(top_.reference_m.x(), top_.reference_m.y(), top_.top_m);
    half_spaces_.push_back({up, up.dot(on_top)});
    half_spaces_.push_back({-Vector3d::UnitZ(), -bottom_m_});
    for (std::size_t k = 0; k < footprint_m_.size(); ++k) {
        const Vector2d edge = footprint_m_[(k + 1) % footprint_m_.size()] - footprint_m_[k];
        const Vector3d outward = Vector3d(edge.y(), -edge.x(), 0.0).normalized();
        half_spaces_.push_back({outward, outward.head<2>().dot(footprint_m_[k])});
    }
    std::vector<Vector3d> low_m;
    std::vector<Vector3d> high_m;
    for (const Vector2d& corner : footprint_m_) {
        low_m.emplace_back(corner.x(), corner.y(), bottom_m_);
        high_m.emplace_back(corner.x(), corner.y(), top_at(corner));
    }
    polygons_m_.push_back(high_m);
    polygons_m_.emplace_back(low_m.rbegin(), low_m.rend());
    for (std::size_t k = 0; k < footprint_m_.size(); ++k) {
        const std::size_t next = (k + 1) % footprint_m_.size();
        polygons_m_.push_back({low_m[k], low_m[next], high_m[next], high_m[k]});
    }
}

/// Clips each ray by the half spaces (Cyrus and Beck 1978). A ray can enter only through a face
/// that is turned to the origin. It must pass the planes of all such faces before it leaves through
/// another face. A ray that begins inside the solid meets nothing.
void Prism::intersect(const Vector3d& origin,
                      std::span<const Vector3d> directions,
                      int first_face,
                      std::span<RayHit> hits) const {
    const Facing seen = facing(origin, first_face);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double enter_m = 0.0;
        int face = -1;
        bool met = seen.towards > 0;
        for (std::size_t k = 0; met && k < seen.towards; ++k) {
            const double speed = seen.sides[k].normal.dot(directions[i]);
            const double t = -seen.sides[k].outside_m / speed;
            met = speed < 0.0 && t < hits[i].distance_m;
            if (t > enter_m) {
                enter_m = t;
                face = seen.sides[k].face;
            }
        }
        for (std::size_t k = seen.towards; met && k < half_spaces_.size(); ++k) {
            const double speed = seen.sides[k].normal.dot(directions[i]);
            // The ray would leave at -outside_m / speed.
            met = !(speed > 0.0 && enter_m * speed >= -seen.sides[k].outside_m);
        }
        if (met) hits[i] = {enter_m, face};
    }
}

void Prism::intersect(const Vector3d& origin,
                      const RayBatch& rays,
                      BatchRange range,
                      int first_face,
                      HitBatch& hits) const {
    const Facing seen = facing(origin, first_face);
    meet_convex(seen.sides.data(), seen.towards, half_spaces_.size(), rays, range, hits);
}

Prism::Facing Prism::facing(const Vector3d& origin, int first_face) const {
    SUREFOOT_ASSERT(half_spaces_.size() <= kMaxFaces);
    Facing seen;
    std::size_t away = half_spaces_.size();
    for (std::size_t k = 0; k < half_spaces_.size(); ++k) {
        const HalfSpace& half = half_spaces_[k];
        const double outside_m = half.normal.dot(origin) - half.offset_m;
        seen.sides[outside_m > 0.0 ? seen.towards++ : --away] = {
            half.normal, outside_m, first_face + static_cast<int>(k)};
    }
    return seen;
}

double Prism::top_at(const Vector2d& p_m) const {
    return top_.top_m + top_.slope.dot(p_m - top_.reference_m);
}

std::optional<Column> Prism::column(double x_m, double y_m) const {
    const Vector2d p_m(x_m, y_m);
    for (std::size_t k = 2; k < half_spaces_.size(); ++k) {
        if (half_spaces_[k].normal.head<2>().dot(p_m) > half_spaces_[k].offset_m + kRim_m) {
            return std::nullopt;
        }
    }
    const double top_m = top_at(p_m);
    if (top_m < bottom_m_ - kRim_m) return std::nullopt;
    return Column{bottom_m_, top_m, 0};
}

/// The top is a plane, so its maximum over the clipped cell lies at a corner.
std::optional<double> Prism::highest_over(const Rect& cell) const {
    const Vector2d low = cell.min_m.array() + kTouch_m;
    const Vector2d high = cell.max_m.array() - kTouch_m;
    std::vector<Vector2d> polygon{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    for (std::size_t k = 2; k < half_spaces_.size() && !polygon.empty(); ++k) {
        polygon = clip(polygon, half_spaces_[k].normal.head<2>(), half_spaces_[k].offset_m);
    }
    if (polygon.size() < 3) return std::nullopt;
    double highest_m = -kInfinity;
    for (const Vector2d& corner : polygon) highest_m = std::max(highest_m, top_at(corner));
    return highest_m;
}

Sphere Prism::bounds() const {
    Vector3d low = Vector3d::Constant(kInfinity);
    Vector3d high = -low;
    for (const Vector2d& corner : footprint_m_) {
        for (const double z_m : {bottom_m_, top_at(corner)}) {
            const Vector3d p(corner.x(), corner.y(), z_m);
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

std::vector<Vector3d> Prism::hull() const {
    std::vector<Vector3d> corners_m = polygons_m_[0];
    corners_m.insert(corners_m.end(), polygons_m_[1].begin(), polygons_m_[1].end());
    return corners_m;
}

std::optional<FacePlane> Prism::only_face(const Beam& beam) const {
    for (std::size_t k = 0; k < half_spaces_.size(); ++k) {
        const HalfSpace& half = half_spaces_[k];
        const double above_m = half.normal.dot(beam.tip_m()) - half.offset_m;
        if (above_m > beam.tip_radius_m() && beam.inside(polygons_m_[k], above_m)) {
            return FacePlane{static_cast<int>(k), half.normal, half.offset_m};
        }
    }
    return std::nullopt;
}

std::vector<FaceFrame> Prism::faces() const {
    const Vector2d edge = (footprint_m_[1] - footprint_m_[0]).normalized();
    std::vector<FaceFrame> frames(2);
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector3d& normal = half_spaces_[k].normal;
        const Vector3d along(edge.x(), edge.y(), 0.0);
        frames[k].normal = normal;
        frames[k].tangent_u = (along - along.dot(normal) * normal).normalized();
        frames[k].tangent_v = normal.cross(frames[k].tangent_u);
    }
    for (std::size_t k = 2; k < half_spaces_.size(); ++k) {
        frames.push_back(side_frame(half_spaces_[k].normal));
    }
    return frames;
}

Cylinder::Cylinder(const Vector2d& center_m, double radius_m, double bottom_m, double top_m)
    : center_m_(center_m), radius_m_(radius_m), bottom_m_(bottom_m), top_m_(top_m) {}

/// Intersects two intervals along the ray: inside the infinite cylinder (roots of a quadratic), and
/// between the planes of the caps.
void Cylinder::intersect(const Vector3d& origin,
                         std::span<const Vector3d> directions,
                         int first_face,
                         std::span<RayHit> hits) const {
    const Vector2d o = origin.head<2>() - center_m_;
    const double c = o.squaredNorm() - radius_m_ * radius_m_;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vector3d& d = directions[i];
        const double a = d.head<2>().squaredNorm();
        const double b = o.dot(d.head<2>());
        const double root2 = b * b - a * c;
        double side_in = -kInfinity;
        double side_out = kInfinity;
        if (a > 0.0) {
            if (!(root2 > 0.0)) continue;
            const double root = std::sqrt(root2);
            side_in = (-b - root) / a;
            side_out = (-b + root) / a;
        } else if (!(c < 0.0)) {
            continue;
        }
        double cap_in = -kInfinity;
        double cap_out = kInfinity;
        int cap_face = 0;
        if (d.z() != 0.0) {
            const double to_top = (top_m_ - origin.z()) / d.z();
            const double to_bottom = (bottom_m_ - origin.z()) / d.z();
            cap_face = d.z() < 0.0 ? 0 : 1;
            cap_in = std::min(to_top, to_bottom);
            cap_out = std::max(to_top, to_bottom);
        } else if (origin.z() > top_m_ || origin.z() < bottom_m_) {
            continue;
        }
        const double enter_m = std::max(side_in, cap_in);
        if (!(enter_m < std::min(side_out, cap_out))) continue;
        shorten(hits[i], enter_m, first_face + (side_in >= cap_in ? 2 : cap_face));
    }
}

void Cylinder::intersect(const Vector3d& origin,
                         const RayBatch& rays,
                         BatchRange range,
                         int first_face,
                         HitBatch& hits) const {
    intersect_each(*this, origin, rays, range, first_face, hits);
}

std::optional<Column> Cylinder::column(double x_m, double y_m) const {
    if ((Vector2d(x_m, y_m) - center_m_).norm() > radius_m_ + kRim_m) return std::nullopt;
    return Column{bottom_m_, top_m_, 0};
}

std::optional<double> Cylinder::highest_over(const Rect& cell) const {
    const Vector2d nearest = center_m_.cwiseMax(cell.min_m).cwiseMin(cell.max_m);
    if ((nearest - center_m_).norm() >= radius_m_ - kTouch_m) return std::nullopt;
    return top_m_;
}

Sphere Cylinder::bounds() const {
    const double half_m = 0.5 * (top_m_ - bottom_m_);
    return {{center_m_.x(), center_m_.y(), bottom_m_ + half_m}, std::hypot(radius_m_, half_m)};
}

std::vector<Vector3d> Cylinder::hull() const {
    const Vector2d corner_m = Vector2d::Constant(radius_m_);
    const Rect square{center_m_ - corner_m, center_m_ + corner_m};
    std::vector<Vector3d> corners_m = corners_of(square, top_m_);
    const std::vector<Vector3d> low_m = corners_of(square, bottom_m_);
    corners_m.insert(corners_m.end(), low_m.begin(), low_m.end());
    return corners_m;
}

std::optional<FacePlane> Cylinder::only_face(const Beam& /*beam*/) const {
    return std::nullopt;
}

std::vector<FaceFrame> Cylinder::faces() const {
    std::vector<FaceFrame> frames(3);
    frames[1].normal = -Vector3d::UnitZ();
    frames[1].tangent_v = -Vector3d::UnitY();
    frames[2].curved = true;
    frames[2].axis_m = center_m_;
    frames[2].radius_m = radius_m_;
    return frames;
}

Prism make_box(const Vector2d& center_m,
               const Vector2d& size_m,
               double bottom_m,
               double top_m,
               double yaw_rad) {
    const Vector2d u = 0.5 * size_m.x() * direction(yaw_rad);
    const Vector2d forward = direction(yaw_rad);
    const Vector2d v = 0.5 * size_m.y() * Vector2d(-forward.y(), forward.x());
    Prism::Top top;
    top.top_m = top_m;
    return {
        {center_m - u - v, center_m + u - v, center_m + u + v, center_m - u + v}, bottom_m, top};
}

Prism make_ramp(const Vector2d& foot_m,
                double length_m,
                double width_m,
                double bottom_m,
                double rise_m,
                double yaw_rad) {
    const Vector2d forward = direction(yaw_rad);
    const Vector2d half = 0.5 * width_m * Vector2d(-forward.y(), forward.x());
    const Vector2d end_m = foot_m + length_m * forward;
    const Prism::Top top{bottom_m, rise_m / length_m * forward, foot_m};
    return {{foot_m - half, end_m - half, end_m + half, foot_m + half}, bottom_m, top};
}

}  // namespace surefoot::sim
