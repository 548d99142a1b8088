// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "surefoot/calibration/lens.hpp"

namespace surefoot::calibration {

/// A rational lens where no board was: nothing but its formula says what happens there, and a
/// formula may let the image turn back before it reaches the corners. A lens does not: every pixel
/// sees something.

/// Away from the axis an image grows with tan(angle), in units of its centre: that of an
/// orthographic lens, which shows angles shorter than the fisheyes that are built, by cos^3(angle).
/// Half of that is left open.
constexpr double kLeastGrowth = 0.5;
constexpr double kGrowthStep = 0.05;  ///< of tan(angle)
constexpr int kGrowthPlaces = 60;     ///< up to 72 deg

inline double growth_place(int i) {
    return kGrowthStep * (i + 0.5);
}

inline double least_growth(double r) {
    return kLeastGrowth * std::pow(1.0 + r * r, -1.5);
}

/// d image / d r of the radial profile at the distance `r` on the plane z = 1; `lens` = fx fy cx cy
/// k1 k2 p1 p2 k3 k4 k5 k6. False beyond a pole.
template <typename T>
bool growth_at(const T* lens, double r, T* growth) {
    const double s = r * r;
    const T above = T(1.0) + s * (lens[4] + s * (lens[5] + s * lens[8]));
    const T below = T(1.0) + s * (lens[9] + s * (lens[10] + s * lens[11]));
    if (!(below > T(0.0))) return false;
    const T d_above = lens[4] + s * (2.0 * lens[5] + s * 3.0 * lens[8]);
    const T d_below = lens[9] + s * (2.0 * lens[10] + s * 3.0 * lens[11]);
    *growth = (above + 2.0 * s * (d_above - above * d_below / below)) / below;
    return true;
}

/// How many places a profile needs to reach the farthest corner of the image when it grows nowhere
/// less than a lens does, and whether it turns back before.
struct GrowthCheck {
    int places = 0;
    bool turns_back = false;
};

inline GrowthCheck check_growth(const double* lens, ImageSize size) {
    const double x = std::max(lens[2], size.width - 1 - lens[2]) / lens[0];
    const double y = std::max(lens[3], size.height - 1 - lens[3]) / lens[1];
    const double corner = std::hypot(x, y);
    GrowthCheck check;
    double reached = 0.0;
    while (check.places < kGrowthPlaces && reached < corner) {
        const double r = growth_place(check.places++);
        double growth = 0.0;
        const bool has_image = growth_at(lens, r, &growth);
        check.turns_back = check.turns_back || !has_image || !(growth > 0.0);
        reached += kGrowthStep * std::max(growth, least_growth(r));
    }
    return check;
}

}  // namespace surefoot::calibration
