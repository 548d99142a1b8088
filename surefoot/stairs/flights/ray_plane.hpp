// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Step between the used columns. Neighbouring columns of a disparity image are redundant.
inline constexpr int kRayStride_px = 4;
/// Correlation length of semi-global matching errors along a row [columns].
inline constexpr double kRayColumns_px = 25.0;
/// Correlation length of semi-global matching errors along a column [rows].
inline constexpr double kRayRows_px = 3.0;

/// A component of the camera's rays along one axis. Rays are scaled to length 1 along the optical
/// axis, so the component is linear in the pixel.
struct RayComponent {
    double at_0 = 0.0;
    double per_u = 0.0;
    double per_v = 0.0;

    /// `axis`: unit vector in the map frame.
    RayComponent(const View& view, const Eigen::Vector3d& axis) {
        const Eigen::Vector3d k = view.T_map_camera.rotation.conjugate() * axis;
        per_u = k.x() / view.fx_px;
        per_v = k.y() / view.fy_px;
        at_0 = k.z() - per_u * view.cx_px - per_v * view.cy_px;
    }
    [[nodiscard]] double at(double u_px, double v_px) const {
        return at_0 + per_u * u_px + per_v * v_px;
    }
};

/// The camera's rays, projected into the plane across an edge. The edge is a point in this plane.
struct RayPlane {
    RayComponent run;    ///< component across the edge, away from the camera
    RayComponent fall;   ///< component downward
    RayComponent aside;  ///< component along the edge

    RayPlane(const View& view, const Eigen::Vector2d& way, const Eigen::Vector2d& along)
        : run(view, {way.x(), way.y(), 0.0}),
          fall(view, -Eigen::Vector3d::UnitZ()),
          aside(view, {along.x(), along.y(), 0.0}) {}

    struct Rows {
        int first = 0;
        int last = -1;  ///< smaller than `first` = empty
    };
    /// The rows of column `u_px` whose rays have a steepness (fall / run) between both values.
    [[nodiscard]] Rows rows_between(double steepness_a,
                                    double steepness_b,
                                    double u_px,
                                    int height_px) const {
        const double a = row_of(steepness_a, u_px);
        const double b = row_of(steepness_b, u_px);
        if (!(std::isfinite(a) && std::isfinite(b))) return {};
        const double most = height_px;
        // in range: finite, as checked, and clamped to the rows of the image
        return {static_cast<int>(std::clamp(std::min(a, b), -1.0, most) + 1.0),
                std::min(
                    static_cast<int>(std::clamp(std::max(a, b), -1.0, most)),  // in range: as above
                    height_px - 1)};
    }
    /// The row of column `u_px` whose ray has this steepness; infinite or NaN = none.
    [[nodiscard]] double row_of(double steepness, double u_px) const {
        return -(fall.at(u_px, 0.0) - steepness * run.at(u_px, 0.0)) /
               (fall.per_v - steepness * run.per_v);
    }
};

}  // namespace surefoot::stairs
