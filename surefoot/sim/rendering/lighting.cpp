// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/lighting.hpp"

#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::sim {

void Lighting::describe(ConfigVisitor& visitor) {
    visitor.number("ambient", ambient, 0.0, 10.0, "even light from all sides");
    visitor.number("lamp", lamp, 0.0, 50.0, "light of the lamp or the sun");
    visitor.number("lamp_azimuth_deg", lamp_azimuth_deg, -360.0, 360.0, "from +x towards +y");
    visitor.number("lamp_elevation_deg", lamp_elevation_deg, 1.0, 90.0, "above the horizon");
    visitor.boolean("shadows", shadows, "the lamp is blocked by what stands in its way");
    visitor.number("stripe_width_m", stripe_width_m, 0.0, 5.0, "sun through a blind; 0 = none");
    visitor.number("stripe_gap_m", stripe_gap_m, 0.001, 5.0, "dark between two stripes");
    visitor.number("stripe_yaw_deg", stripe_yaw_deg, -360.0, 360.0, "turn about the lamp's rays");
}

Eigen::Vector3d Lighting::towards_lamp() const {
    const double elevation_rad = lamp_elevation_deg * kRadPerDeg;
    const double azimuth_rad = lamp_azimuth_deg * kRadPerDeg;
    return {std::cos(elevation_rad) * std::cos(azimuth_rad),
            std::cos(elevation_rad) * std::sin(azimuth_rad),
            std::sin(elevation_rad)};
}

}  // namespace surefoot::sim
