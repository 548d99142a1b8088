// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Tolerance of heights. A surface is buried if another solid begins at the surface or below and
/// ends above the surface.
constexpr double kTouch_m = 1e-9;

}  // namespace

const char* to_string(Label label) noexcept {
    return kLabelNames[static_cast<std::size_t>(label)];
}

int Scene::add_material(const Material& material) {
    materials_.push_back(material);
    return static_cast<int>(materials_.size()) - 1;
}

void Scene::add(Primitive primitive, int material, Label label) {
    SUREFOOT_ASSERT(material >= 0 && material < static_cast<int>(materials_.size()));
    const int index = primitives();
    first_surface_.push_back(static_cast<int>(surfaces_.size()));
    bounds_.push_back(std::visit([](const auto& shape) { return shape.bounds(); }, primitive));
    hulls_.push_back(std::visit([](const auto& shape) { return shape.hull(); }, primitive));
    const auto faces = std::visit([](const auto& shape) { return shape.faces(); }, primitive);
    for (const FaceFrame& face : faces) surfaces_.push_back({face, index, material, label});
    primitives_.push_back(std::move(primitive));
}

void Scene::add_floor(const Floor& floor, int material, int pit_material, Label label) {
    const std::size_t first = surfaces_.size();
    add(floor, material, label);
    for (std::size_t face = first + 1; face < surfaces_.size(); ++face) {
        surfaces_[face].material = pit_material;
        surfaces_[face].label = Label::drop;
    }
}

void Scene::intersect_primitive(int primitive,
                                const Vector3d& origin_m,
                                std::span<const Vector3d> directions,
                                std::span<RayHit> hits) const {
    const auto index = static_cast<std::size_t>(primitive);
    std::visit(
        [&](const auto& shape) {
            shape.intersect(origin_m, directions, first_surface_[index], hits);
        },
        primitives_[index]);
}

void Scene::intersect_primitive(int primitive,
                                const Vector3d& origin_m,
                                const RayBatch& rays,
                                BatchRange range,
                                HitBatch& hits) const {
    const auto index = static_cast<std::size_t>(primitive);
    std::visit(
        [&](const auto& shape) {
            shape.intersect(origin_m, rays, range, first_surface_[index], hits);
        },
        primitives_[index]);
}

std::optional<Hit> Scene::intersect(const Vector3d& origin_m, const Vector3d& direction) const {
    RayHit nearest;
    for (int k = 0; k < primitives(); ++k) {
        intersect_primitive(k, origin_m, {&direction, 1}, {&nearest, 1});
    }
    if (nearest.face < 0) return std::nullopt;
    const Vector3d point_m = origin_m + nearest.distance_m * direction;
    return Hit{nearest.distance_m, point_m, nearest.face, surface_point(nearest.face, point_m)};
}

bool Scene::blocked(const Vector3d& origin_m, const Vector3d& direction, double distance_m) const {
    RayHit nearest{distance_m, -1};
    for (int k = 0; k < primitives() && nearest.face < 0; ++k) {
        intersect_primitive(k, origin_m, {&direction, 1}, {&nearest, 1});
    }
    return nearest.face >= 0;
}

SurfacePoint Scene::surface_point(int surface, const Vector3d& point_m) const {
    const FaceFrame& frame = surfaces_[static_cast<std::size_t>(surface)].frame;
    if (!frame.curved) {
        return {frame.normal,
                frame.tangent_u,
                frame.tangent_v,
                frame.tangent_u.dot(point_m),
                frame.tangent_v.dot(point_m)};
    }
    const Eigen::Vector2d radial = (point_m.head<2>() - frame.axis_m).normalized();
    const Vector3d normal(radial.x(), radial.y(), 0.0);
    return {normal,
            {-radial.y(), radial.x(), 0.0},
            Vector3d::UnitZ(),
            frame.radius_m * std::atan2(radial.y(), radial.x()),
            point_m.z()};
}

std::vector<SurfaceHeight> Scene::surfaces_at(double x_m, double y_m) const {
    std::vector<Column> columns;
    std::vector<SurfaceHeight> tops;
    for (std::size_t k = 0; k < primitives_.size(); ++k) {
        const auto column =
            std::visit([&](const auto& shape) { return shape.column(x_m, y_m); }, primitives_[k]);
        if (!column) continue;
        columns.push_back(*column);
        tops.push_back({column->top_m, first_surface_[k] + column->face});
    }
    const auto buried = [&](const SurfaceHeight& top) {
        return std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
            return column.bottom_m <= top.z_m + kTouch_m && column.top_m > top.z_m + kTouch_m;
        });
    };
    std::erase_if(tops, buried);
    std::stable_sort(
        tops.begin(), tops.end(), [](const auto& a, const auto& b) { return a.z_m > b.z_m; });
    return tops;
}

std::optional<SurfaceHeight> Scene::height_at(double x_m, double y_m) const {
    std::optional<SurfaceHeight> highest;
    for (std::size_t k = 0; k < primitives_.size(); ++k) {
        const auto column =
            std::visit([&](const auto& shape) { return shape.column(x_m, y_m); }, primitives_[k]);
        if (!column || (highest && column->top_m <= highest->z_m)) continue;
        highest = SurfaceHeight{column->top_m, first_surface_[k] + column->face};
    }
    return highest;
}

std::optional<int> Scene::solid_at(const Vector3d& point_m) const {
    for (int k = 0; k < primitives(); ++k) {
        const auto column =
            std::visit([&](const auto& shape) { return shape.column(point_m.x(), point_m.y()); },
                       primitives_[static_cast<std::size_t>(k)]);
        if (column && point_m.z() >= column->bottom_m && point_m.z() <= column->top_m) return k;
    }
    return std::nullopt;
}

std::optional<double> Scene::highest_over(const Rect& cell) const {
    std::optional<double> highest;
    for (const Primitive& primitive : primitives_) {
        const auto top =
            std::visit([&](const auto& shape) { return shape.highest_over(cell); }, primitive);
        if (top && (!highest || *top > *highest)) highest = top;
    }
    return highest;
}

const Primitive& Scene::primitive(int index) const {
    return primitives_[static_cast<std::size_t>(index)];
}

const Sphere& Scene::bounds(int primitive) const {
    return bounds_[static_cast<std::size_t>(primitive)];
}

const std::vector<Vector3d>& Scene::hull(int primitive) const {
    return hulls_[static_cast<std::size_t>(primitive)];
}

std::optional<FacePlane> Scene::only_face(int primitive, const Beam& beam) const {
    const auto index = static_cast<std::size_t>(primitive);
    auto plane =
        std::visit([&](const auto& shape) { return shape.only_face(beam); }, primitives_[index]);
    if (plane) plane->face += first_surface_[index];
    return plane;
}

}  // namespace surefoot::sim
