// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Neighbouring columns of a disparity image say the same.
inline constexpr int kSightStride_px = 4;
/// Errors of a semi-global matcher hang together over so many columns ...
inline constexpr double kSightColumns_px = 25.0;
/// ... and rows.
inline constexpr double kSightRows_px = 3.0;

/// A component of the lines of sight of a camera, each as long as 1 along the optical axis, linear
/// in the pixel.
struct SightComponent {
    double at_0 = 0.0;
    double per_u = 0.0;
    double per_v = 0.0;

    /// `axis`: unit vector in the frame of the map.
    SightComponent(const View& view, const Eigen::Vector3d& axis) {
        const Eigen::Vector3d k = view.T_map_camera.rotation.conjugate() * axis;
        per_u = k.x() / view.fx_px;
        per_v = k.y() / view.fy_px;
        at_0 = k.z() - per_u * view.cx_px - per_v * view.cy_px;
    }
    [[nodiscard]] double at(double u_px, double v_px) const {
        return at_0 + per_u * u_px + per_v * v_px;
    }
};

/// The lines of sight as seen along an edge: in the plane across it, its points are one.
struct SightPlane {
    SightComponent run;    ///< across the edge, away from the camera
    SightComponent fall;   ///< downward
    SightComponent aside;  ///< along the edge

    SightPlane(const View& view, const Eigen::Vector2d& way, const Eigen::Vector2d& along)
        : run(view, {way.x(), way.y(), 0.0}),
          fall(view, -Eigen::Vector3d::UnitZ()),
          aside(view, {along.x(), along.y(), 0.0}) {}

    /// Row of a column in which lines of sight have this fall over run; infinite or NaN = none.
    [[nodiscard]] double row_of(double steepness, double u_px) const {
        return -(fall.at(u_px, 0.0) - steepness * run.at(u_px, 0.0)) /
               (fall.per_v - steepness * run.per_v);
    }
};

}  // namespace surefoot::stairs
