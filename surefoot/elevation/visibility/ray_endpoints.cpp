// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/ray_endpoints.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

/// Smallest distance [cells] from the camera: the larger of |dx| and |dy|. Nearer cells have no
/// useful direction.
constexpr float kNearest = 2.0F;
/// First cell beyond a surface in which an endpoint counts. A surface covers one or two cells, so a
/// nearer endpoint may lie on the surface itself.
constexpr int kOwnCells = 3;

}  // namespace

void RayEndpoints::reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m) {
    geometry_ = geometry;
    camera_cells_ =
        ((camera_m.head<2>() - geometry.origin_m) / geometry.resolution_m).cast<float>();
    camera_z_m_ = static_cast<float>(camera_m.z());
    const auto cells =
        static_cast<std::size_t>(geometry.nx) * static_cast<std::size_t>(geometry.ny);
    z_m_.assign(cells, kNanF);
    bottom_m_.resize(cells);
}

bool RayEndpoints::passed_through(grid::Cell cell, float low_m, float high_m) const {
    return passed(cell, low_m) && passed(cell, high_m);
}

bool RayEndpoints::passed(grid::Cell cell, float z_m) const {
    const Eigen::Vector2f from(static_cast<float>(cell.ix) + 0.5F,
                               static_cast<float>(cell.iy) + 0.5F);
    const Eigen::Vector2f away = from - camera_cells_;
    const float distance = away.cwiseAbs().maxCoeff();
    if (!(distance >= kNearest)) return false;
    const Eigen::Vector2f step = away / distance;
    const float fall_m = (camera_z_m_ - z_m) / distance;  // fall of the line per step
    const float rounding_m = std::abs(fall_m);
    for (int k = kOwnCells;; ++k) {
        const auto steps = static_cast<float>(k);
        const Eigen::Vector2f at = from + steps * step;
        if (!(at.x() >= 0.0F && at.y() >= 0.0F && at.x() < static_cast<float>(geometry_.nx) &&
              at.y() < static_cast<float>(geometry_.ny))) {
            return false;
        }
        // in range: inside the grid, see above
        const auto i = static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(geometry_.nx) +
                       static_cast<std::size_t>(at.x());  // in range: inside the grid
        if (std::isnan(z_m_[i])) continue;
        const float line_z_m = z_m - steps * fall_m;
        if (line_z_m > z_m_[i] + rounding_m) continue;
        // The line meets this surface or passes below it. The endpoint of a line below the surface
        // was not observed.
        return line_z_m >= bottom_m_[i] - rounding_m;
    }
}

}  // namespace surefoot::elevation
