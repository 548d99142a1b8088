// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/ray_caster.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// An object that touches a plane from behind does not count as hidden, because rounding errors
/// decide which surface is visible.
constexpr double kBehind_m = 1e-6;

/// Angle between two rotations, from |A - B| (Frobenius) = 2 sqrt(2) sin(angle / 2).
double angle_between_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    const double half_sine = std::min((a - b).norm() / (2.0 * std::sqrt(2.0)), 1.0);
    return 2.0 * std::asin(half_sine);
}

/// Cone of the block from its middle row, widened by the motion of the camera between this row and
/// the other rows.
Beam beam_of(const RayField& rays,
             const ImageViews& views,
             const CastBlock& block,
             const RayField::Cone& cone) {
    const int v_middle = block.v0 + block.height / 2;
    const CameraView& middle = views.row(v_middle);
    double tip_radius_m = 0.0;
    double turn_rad = 0.0;
    for (int v = block.v0; !views.single() && v < block.v0 + block.height; ++v) {
        const CameraView& view = views.row(v);
        tip_radius_m = std::max(tip_radius_m, (view.origin_m - middle.origin_m).norm());
        turn_rad =
            std::max(turn_rad, angle_between_rad(view.R_world_camera, middle.R_world_camera));
    }
    // Points within a pixel lie up to half a pixel diagonal outside the outermost rays.
    const double pixel_rad = rays.pixel_angle_rad(block.u0 + block.width / 2, v_middle);
    return {middle.origin_m,
            middle.R_world_camera * cone.axis,
            cone.half_angle_rad + pixel_rad + turn_rad,
            tip_radius_m};
}

/// Removes primitives that are hidden by the one face that fills the beam.
void drop_hidden(const Scene& scene, const Beam& beam, CastBlock& out) {
    for (const int k : out.primitives) {
        const auto plane = scene.only_face(k, beam);
        if (!plane) continue;
        std::erase_if(out.primitives, [&](int other) {
            const auto& hull_m = scene.hull(other);
            return other != k &&
                   std::all_of(hull_m.begin(), hull_m.end(), [&](const Vector3d& corner_m) {
                       return plane->normal.dot(corner_m) < plane->offset_m - kBehind_m;
                   });
        });
        if (out.primitives.size() == 1) out.plane = plane;
        return;
    }
}

void place(const RayField& rays, int block_x, int block_y, CastBlock& out) {
    out.u0 = block_x * RayField::kBlock;
    out.v0 = block_y * RayField::kBlock;
    out.width = std::min(RayField::kBlock, rays.width() - out.u0);
    out.height = std::min(RayField::kBlock, rays.height() - out.v0);
}

/// Calls `work(row, rays)` once for all neighbouring rows that share their view.
template <typename Work>
void for_each_view(const ImageViews& views, const CastBlock& block, const Work& work) {
    const auto width = static_cast<std::size_t>(block.width);
    const std::size_t span = views.single() ? block.pixels() : width;
    for (std::size_t first = 0; first < block.pixels(); first += span) {
        work(block.v0 + static_cast<int>(first / width), BatchRange{first, first + span});
    }
}

}  // namespace

void find_primitives(const Scene& scene,
                     const RayField& rays,
                     const ImageViews& views,
                     int block_x,
                     int block_y,
                     CastBlock& out) {
    place(rays, block_x, block_y, out);
    out.primitives.clear();
    out.plane.reset();
    const RayField::Cone& cone = rays.cone(block_x, block_y);
    if (cone.empty) return;
    const Beam beam = beam_of(rays, views, out, cone);
    for (int k = 0; k < scene.primitives(); ++k) {
        if (!beam.misses(scene.bounds(k)) && !beam.misses(scene.hull(k)))
            out.primitives.push_back(k);
    }
    drop_hidden(scene, beam, out);
}

void cast_block(const Scene& scene,
                const RayField& rays,
                const ImageViews& views,
                int block_x,
                int block_y,
                CastBlock& out) {
    find_primitives(scene, rays, views, block_x, block_y, out);
    const RayField::BlockRays block = rays.block(block_x, block_y);
    for_each_view(views, out, [&](int v, BatchRange range) {
        turn_rays(views.row(v).R_world_camera, block.x, block.y, block.z, range, out.directions);
    });
    if (out.plane) {
        const FacePlane& plane = *out.plane;
        for_each_view(views, out, [&](int v, BatchRange range) {
            const double above_m = plane.normal.dot(views.row(v).origin_m) - plane.offset_m;
            meet_plane(plane.normal, above_m, plane.face, out.directions, range, out.hits);
        });
        return;
    }
    std::fill_n(out.hits.distance_m.begin(), out.pixels(), RayHit{}.distance_m);
    std::fill_n(out.hits.face.begin(), out.pixels(), RayHit{}.face);
    for (const int k : out.primitives) {
        for_each_view(views, out, [&](int v, BatchRange range) {
            scene.intersect_primitive(k, views.row(v).origin_m, out.directions, range, out.hits);
        });
    }
}

}  // namespace surefoot::sim
