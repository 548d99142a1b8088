// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/lighting.hpp"

#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::sim {

void Lighting::describe(ConfigVisitor& visitor) {
    visitor.number("ambient",
                   ambient,
                   0.0,
                   10.0,
                   "brightness of the uniform light from all sides; a fully lit white surface = 1");
    visitor.number("lamp",
                   lamp,
                   0.0,
                   50.0,
                   "brightness of the lamp or the sun; a fully lit white surface = 1");
    visitor.number("lamp_azimuth_deg",
                   lamp_azimuth_deg,
                   -360.0,
                   360.0,
                   "angle of the direction to the lamp: 0 = along +x, 90 = along +y");
    visitor.number("lamp_elevation_deg",
                   lamp_elevation_deg,
                   1.0,
                   90.0,
                   "elevation of the lamp above the horizon");
    visitor.boolean("shadows", shadows, "true: objects cast shadows in the light of the lamp");
    visitor.number("stripe_width_m",
                   stripe_width_m,
                   0.0,
                   5.0,
                   "width of the bright stripes of light through a blind; 0 = no stripes");
    visitor.number("stripe_gap_m",
                   stripe_gap_m,
                   0.001,
                   5.0,
                   "width of the dark gap between two bright stripes");
    visitor.number("stripe_yaw_deg",
                   stripe_yaw_deg,
                   -360.0,
                   360.0,
                   "rotation of the stripes about the direction of the lamp");
}

Eigen::Vector3d Lighting::towards_lamp() const {
    const double elevation_rad = lamp_elevation_deg * kRadPerDeg;
    const double azimuth_rad = lamp_azimuth_deg * kRadPerDeg;
    return {std::cos(elevation_rad) * std::cos(azimuth_rad),
            std::cos(elevation_rad) * std::sin(azimuth_rad),
            std::sin(elevation_rad)};
}

}  // namespace surefoot::sim
