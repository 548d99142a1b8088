// SPDX-License-Identifier: Apache-2.0
#include "sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Rounding of cosines near 1.
constexpr double kMargin_rad = 1e-6;

/// A cone whose tip may be anywhere in a small ball.
struct SweptCone {
    Vector3d tip_m;
    Vector3d axis;
    double half_angle_rad = 0.0;
    double tip_radius_m = 0.0;
};

bool may_meet(const Sphere& sphere, const SweptCone& cone) {
    const Vector3d to_center = sphere.center_m - cone.tip_m;
    const double distance_m = to_center.norm();
    const double radius_m = sphere.radius_m + cone.tip_radius_m;
    if (distance_m <= radius_m) return true;
    const double to_axis_rad =
        std::acos(std::clamp(cone.axis.dot(to_center) / distance_m, -1.0, 1.0));
    return to_axis_rad <= cone.half_angle_rad + std::asin(radius_m / distance_m) + kMargin_rad;
}

/// Angle between two rotations, a little too large: |A - B| (Frobenius) = 2 sqrt(2) sin(angle / 2).
double angle_between_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    const double half_sine = std::min((a - b).norm() / (2.0 * std::sqrt(2.0)), 1.0);
    return 2.0 * std::asin(half_sine);
}

/// The cone of the block seen from its middle row, widened by the way to its other rows.
SweptCone swept_cone(const RayField& rays,
                     const ImageViews& views,
                     const CastBlock& block,
                     const RayField::Cone& cone) {
    const CameraView& middle = views.row(block.v0 + block.height / 2);
    SweptCone swept{middle.origin_m, middle.R_world_camera * cone.axis, cone.half_angle_rad, 0.0};
    // Places within a pixel lie up to half a pixel diagonal outside the outermost rays.
    const int u = block.u0 + block.width / 2;
    swept.half_angle_rad += rays.pixel_angle_rad(u, block.v0 + block.height / 2);
    if (views.single()) return swept;
    double turn_rad = 0.0;
    for (int v = block.v0; v < block.v0 + block.height; ++v) {
        const CameraView& view = views.row(v);
        swept.tip_radius_m = std::max(swept.tip_radius_m, (view.origin_m - middle.origin_m).norm());
        turn_rad =
            std::max(turn_rad, angle_between_rad(view.R_world_camera, middle.R_world_camera));
    }
    swept.half_angle_rad += turn_rad;
    return swept;
}

void place(const RayField& rays, int block_x, int block_y, CastBlock& out) {
    out.u0 = block_x * RayField::kBlock;
    out.v0 = block_y * RayField::kBlock;
    out.width = std::min(RayField::kBlock, rays.width() - out.u0);
    out.height = std::min(RayField::kBlock, rays.height() - out.v0);
}

void turn_rays(const RayField& rays, const ImageViews& views, CastBlock& out) {
    std::size_t i = 0;
    for (int v = out.v0; v < out.v0 + out.height; ++v) {
        const Eigen::Matrix3d& R_world_camera = views.row(v).R_world_camera;
        for (int u = out.u0; u < out.u0 + out.width; ++u) {
            out.directions[i++] = R_world_camera * rays.ray(u, v);
        }
    }
}

/// The one surface of a block, or -1.
int only_surface(const RayField& rays, const Image<std::int16_t>& surface, int x, int y) {
    CastBlock block;
    place(rays, x, y, block);
    const int face = surface.row(block.v0)[block.u0];
    for (int v = block.v0; v < block.v0 + block.height; ++v) {
        const std::int16_t* row = surface.row(v) + block.u0;
        if (std::any_of(row, row + block.width, [&](int other) { return other != face; }))
            return -1;
    }
    return face;
}

}  // namespace

std::vector<BlockPlane> find_planes(const Scene& scene,
                                    const RayField& rays,
                                    const ImageViews& views,
                                    const Image<std::int16_t>& surface,
                                    const Image<float>& depth_m) {
    Image<int> only(rays.blocks_x(), rays.blocks_y());
    for (int y = 0; y < only.height(); ++y) {
        for (int x = 0; x < only.width(); ++x) only.at(x, y) = only_surface(rays, surface, x, y);
    }
    std::vector<BlockPlane> planes(only.size());
    for (int y = 1; y + 1 < only.height(); ++y) {
        for (int x = 1; x + 1 < only.width(); ++x) {
            const int face = only.at(x, y);
            if (face < 0 || scene.surfaces()[static_cast<std::size_t>(face)].frame.curved) continue;
            bool alone = true;
            for (int i = 0; i < 9; ++i)
                alone = alone && only.at(x - 1 + i % 3, y - 1 + i / 3) == face;
            if (!alone) continue;
            const int u = x * RayField::kBlock;
            const int v = y * RayField::kBlock;
            const Vector3d& ray = rays.ray(u, v);
            const double distance_m = static_cast<double>(depth_m.at(u, v)) / ray.z();
            const CameraView& view = views.row(v);
            // Within a block depth does not fall below half of that of a corner, unless the plane
            // is seen at a grazing angle; then so much the better: it lies further away.
            planes[static_cast<std::size_t>(y * only.width() + x)] = {
                face, view.origin_m + distance_m * (view.R_world_camera * ray), 0.5 * distance_m};
        }
    }
    return planes;
}

bool cast_on_plane(const Scene& scene,
                   const RayField& rays,
                   const ImageViews& before,
                   const ImageViews& now,
                   const BlockPlane& plane,
                   int block_x,
                   int block_y,
                   CastBlock& out) {
    place(rays, block_x, block_y, out);
    const CameraView& then = before.row(out.v0);
    const CameraView& view = now.row(out.v0);
    const double moved_rad = angle_between_rad(then.R_world_camera, view.R_world_camera) +
                             (then.origin_m - view.origin_m).norm() / plane.nearest_m;
    // The surrounding blocks are a margin of 16 pixels; rows differ a little from the first one.
    constexpr double kMargin_px = 0.5 * RayField::kBlock;
    if (moved_rad > kMargin_px * rays.pixel_angle_rad(out.u0, out.v0)) return false;
    turn_rays(rays, now, out);
    const Vector3d& normal = scene.surfaces()[static_cast<std::size_t>(plane.face)].frame.normal;
    std::size_t i = 0;
    for (int v = out.v0; v < out.v0 + out.height; ++v) {
        const double above_m = normal.dot(now.row(v).origin_m - plane.point_m);
        for (int u = out.u0; u < out.u0 + out.width; ++u, ++i) {
            out.hits[i] = {-above_m / normal.dot(out.directions[i]), plane.face};
        }
    }
    return true;
}

void find_primitives(const Scene& scene,
                     const RayField& rays,
                     const ImageViews& views,
                     int block_x,
                     int block_y,
                     CastBlock& out) {
    place(rays, block_x, block_y, out);
    out.primitives.clear();
    const RayField::Cone& cone = rays.cone(block_x, block_y);
    if (cone.empty) return;
    const SweptCone swept = swept_cone(rays, views, out, cone);
    for (int k = 0; k < scene.primitives(); ++k) {
        if (may_meet(scene.bounds(k), swept)) out.primitives.push_back(k);
    }
}

void cast_block(const Scene& scene,
                const RayField& rays,
                const ImageViews& views,
                int block_x,
                int block_y,
                CastBlock& out) {
    find_primitives(scene, rays, views, block_x, block_y, out);
    turn_rays(rays, views, out);
    const auto width = static_cast<std::size_t>(out.width);
    const std::size_t count = width * static_cast<std::size_t>(out.height);
    std::fill_n(out.hits.begin(), count, RayHit{});
    // Rows that share their view are cast at once.
    const std::size_t span = views.single() ? count : width;
    for (const int k : out.primitives) {
        for (std::size_t first = 0; first < count; first += span) {
            const int row = out.v0 + static_cast<int>(first / width);
            scene.intersect_primitive(k,
                                      views.row(row).origin_m,
                                      {out.directions.data() + first, span},
                                      {out.hits.data() + first, span});
        }
    }
}

}  // namespace surefoot::sim
