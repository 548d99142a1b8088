// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// Lighting of a scene: uniform ambient light plus one distant lamp or sun. Light through a blind
/// falls in stripes.
struct Lighting {
    double ambient = 0.45;             ///< uniform part; a fully lit white surface = 1
    double lamp = 0.55;                ///< directed part; a fully lit white surface = 1
    double lamp_azimuth_deg = -53.0;   ///< direction to the lamp: 0 = along +x, 90 = along +y
    double lamp_elevation_deg = 60.0;  ///< angle above the horizon
    bool shadows = false;              ///< true: objects block the lamp
    double stripe_width_m = 0.0;       ///< width of a bright stripe, across the rays; 0 = none
    double stripe_gap_m = 0.1;         ///< width of the dark gap between two stripes
    double stripe_yaw_deg = 0.0;       ///< turn of the stripes about the direction of the lamp

    void describe(ConfigVisitor& visitor);
    [[nodiscard]] Eigen::Vector3d towards_lamp() const;
};

}  // namespace surefoot::sim
