// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// Keeps a lens model plausible where no board was seen. There the model is extrapolated, and its
/// image can fold back before the image corners; real lenses do not fold back. A profile gives the
/// growth of the image at a `place`, relative to the growth at the centre. `kLeastGrowth` is the
/// limit, as a share of the least growth of real lenses.
inline constexpr double kLeastGrowth = 0.5;
inline constexpr double kGrowthStep = 0.05;  ///< step of tan(angle); fisheye: of the angle [rad]
inline constexpr int kGrowthPlaces = 60;     ///< places to 72 deg (pinhole) or 172 deg (fisheye)

inline double growth_place(int i) {
    return kGrowthStep * (i + 0.5);
}

/// `lens` = fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6; a place is a value of tan(angle).
struct PinholeGrowth {
    static constexpr int kParameters = 12;

    /// Half the growth of an orthographic lens, which grows less than real fisheye lenses.
    static double least(double r) { return kLeastGrowth * std::pow(1.0 + r * r, -1.5); }

    /// Computes d image / d r of the radial profile at distance `r` on the plane z = 1. Returns
    /// false beyond a pole of the profile.
    template <typename T>
    static bool at(const T* lens, double r, T* growth) {
        const double s = r * r;
        const T above = T(1.0) + s * (lens[4] + s * (lens[5] + s * lens[8]));
        const T below = T(1.0) + s * (lens[9] + s * (lens[10] + s * lens[11]));
        if (!(below > T(0.0))) return false;
        const T d_above = lens[4] + s * (2.0 * lens[5] + s * 3.0 * lens[8]);
        const T d_below = lens[9] + s * (2.0 * lens[10] + s * 3.0 * lens[11]);
        *growth = (above + 2.0 * s * (d_above - above * d_below / below)) / below;
        return true;
    }
};

/// `lens` = fx fy cx cy k1 k2 k3 k4 of Kannala and Brandt; a place is an angle [rad].
struct FisheyeGrowth {
    static constexpr int kParameters = 8;

    /// Half the growth of an equisolid lens: the image of an orthographic lens ends at 90 deg.
    static double least(double theta) { return kLeastGrowth * std::cos(0.5 * theta); }

    /// Computes d image / d theta. Always returns true.
    template <typename T>
    static bool at(const T* lens, double theta, T* growth) {
        const double s = theta * theta;
        *growth = T(1.0) + s * (3.0 * lens[4] +
                                s * (5.0 * lens[5] + s * (7.0 * lens[6] + s * (9.0 * lens[7]))));
        return true;
    }
};

/// Number of places until the profile reaches the farthest image corner, and whether the profile
/// folds back before this corner. A growth below the limit counts as the limit.
struct GrowthCheck {
    int places = 0;
    bool turns_back = false;
};

template <typename Profile>
GrowthCheck check_growth(const double* lens, ImageSize size) {
    const double x = std::max(lens[2], size.width - 1 - lens[2]) / lens[0];
    const double y = std::max(lens[3], size.height - 1 - lens[3]) / lens[1];
    const double corner = std::hypot(x, y);
    GrowthCheck check;
    double reached = 0.0;
    while (check.places < kGrowthPlaces && reached < corner) {
        const double place = growth_place(check.places++);
        double growth = 0.0;
        const bool has_image = Profile::at(lens, place, &growth);
        check.turns_back = check.turns_back || !has_image || !(growth > 0.0);
        reached += kGrowthStep * std::max(growth, Profile::least(place));
    }
    return check;
}

/// Residuals for a least-squares solver: how far the image growth is below the limit.
template <typename Profile>
struct GrowthLack {
    int places = 0;
    double weight_px = 0.0;

    template <typename T>
    bool operator()(const T* lens, T* residual) const {
        std::fill(residual, residual + kGrowthPlaces, T(0.0));
        for (int i = 0; i < places; ++i) {
            const double least = Profile::least(growth_place(i));
            T growth = T(0.0);
            (void)Profile::at(lens, growth_place(i), &growth);
            if (growth < T(least)) residual[i] = weight_px * (T(least) - growth);
        }
        return true;
    }
};

}  // namespace surefoot::calibration
