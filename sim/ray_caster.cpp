// SPDX-License-Identifier: Apache-2.0
#include "sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

bool may_meet(const Sphere& sphere,
              const Vector3d& origin_m,
              const Vector3d& axis,
              double half_angle_rad) {
    const Vector3d to_center = sphere.center_m - origin_m;
    const double distance_m = to_center.norm();
    if (distance_m <= sphere.radius_m) return true;
    const double to_axis_rad = std::acos(std::clamp(axis.dot(to_center) / distance_m, -1.0, 1.0));
    return to_axis_rad <= half_angle_rad + std::asin(sphere.radius_m / distance_m) + 1e-6;
}

}  // namespace

void cast_block(const Scene& scene,
                const RayField& rays,
                const Pose& T_world_camera,
                int block_x,
                int block_y,
                CastBlock& out) {
    out.u0 = block_x * RayField::kBlock;
    out.v0 = block_y * RayField::kBlock;
    out.width = std::min(RayField::kBlock, rays.width() - out.u0);
    out.height = std::min(RayField::kBlock, rays.height() - out.v0);
    const int pixels = out.width * out.height;
    const auto count = static_cast<std::size_t>(pixels);
    std::fill_n(out.hits.begin(), count, RayHit{});
    const RayField::Cone& cone = rays.cone(block_x, block_y);
    if (cone.empty) return;

    const Eigen::Matrix3d R_world_camera = T_world_camera.R();
    std::size_t i = 0;
    for (int v = out.v0; v < out.v0 + out.height; ++v) {
        for (int u = out.u0; u < out.u0 + out.width; ++u) {
            out.directions[i++] = R_world_camera * rays.ray(u, v);
        }
    }
    const Vector3d axis = R_world_camera * cone.axis;
    for (int k = 0; k < scene.primitives(); ++k) {
        if (!may_meet(scene.bounds(k), T_world_camera.translation_m, axis, cone.half_angle_rad)) {
            continue;
        }
        scene.intersect_primitive(k,
                                  T_world_camera.translation_m,
                                  {out.directions.data(), count},
                                  {out.hits.data(), count});
    }
}

}  // namespace surefoot::sim
