// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/sightings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

/// Returns the column of a point that falls into the image. Pixel u covers [u - 0.5, u + 0.5).
std::optional<double> column_of(const Eigen::Vector3d& p_camera,
                                const PinholeView& view,
                                double max_depth_m) {
    if (!(p_camera.z() > 0.0 && p_camera.z() <= max_depth_m)) return std::nullopt;
    const double u_px = view.fx_px * p_camera.x() / p_camera.z() + view.cx_px;
    const double v_px = view.fy_px * p_camera.y() / p_camera.z() + view.cy_px;
    const bool inside =
        u_px >= -0.5 && u_px < view.width - 0.5 && v_px >= -0.5 && v_px < view.height - 0.5;
    return inside ? std::optional(u_px) : std::nullopt;
}

}  // namespace

Sightings last_sightings(const grid::GridGeometry& geometry,
                         const grid::Layer& height_m,
                         const Trajectory& T_world_camera,
                         const PinholeView& view,
                         double max_depth_m) {
    SUREFOOT_ASSERT(height_m.width() == geometry.nx && height_m.height() == geometry.ny);
    std::vector<Pose> T_camera_world;
    for (const StampedPose& pose : T_world_camera)
        T_camera_world.push_back(pose.T_world_body.inverse());
    Sightings seen{grid::Layer(geometry.nx, geometry.ny, kNanF),
                   grid::Layer(geometry.nx, geometry.ny, kNanF)};
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const auto z_m = static_cast<double>(height_m.at(ix, iy));
            if (!std::isfinite(z_m)) continue;
            const Eigen::Vector2d center_m = geometry.center_m({ix, iy});
            const Eigen::Vector3d p_world(center_m.x(), center_m.y(), z_m);
            for (std::size_t k = T_camera_world.size(); k-- > 0;) {
                const auto u_px = column_of(T_camera_world[k] * p_world, view, max_depth_m);
                if (!u_px) continue;
                const Eigen::Vector3d& camera_m = T_world_camera[k].T_world_body.translation_m;
                seen.column_px.at(ix, iy) = static_cast<float>(*u_px);
                seen.range_m.at(ix, iy) =
                    static_cast<float>((center_m - camera_m.head<2>()).norm());
                break;
            }
        }
    }
    return seen;
}

grid::Layer distance_to(const grid::GridGeometry& geometry, const Trajectory& trajectory) {
    grid::Layer distance_m(geometry.nx, geometry.ny, kNanF);
    if (trajectory.empty()) return distance_m;
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const Eigen::Vector2d center_m = geometry.center_m({ix, iy});
            double nearest_sq_m2 = std::numeric_limits<double>::infinity();
            for (const StampedPose& pose : trajectory) {
                const Eigen::Vector2d to_m = pose.T_world_body.translation_m.head<2>() - center_m;
                nearest_sq_m2 = std::min(nearest_sq_m2, to_m.squaredNorm());
            }
            distance_m.at(ix, iy) = static_cast<float>(std::sqrt(nearest_sq_m2));
        }
    }
    return distance_m;
}

}  // namespace surefoot::eval
