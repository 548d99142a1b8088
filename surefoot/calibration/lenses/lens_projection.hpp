// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace surefoot::calibration {

/// Formulas of camera/pinhole_rational.hpp and camera/kannala_brandt.hpp, for plain numbers and for
/// numbers with derivatives. They return false if a point has no image.

/// `lens` = fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6.
template <typename T>
bool project_pinhole(const T* lens, const T* p, T* pixel) {
    if (!(p[2] > T(0.0))) return false;
    const T x = p[0] / p[2];
    const T y = p[1] / p[2];
    const T r2 = x * x + y * y;
    const T below = T(1.0) + r2 * (lens[9] + r2 * (lens[10] + r2 * lens[11]));
    if (!(below > T(0.0))) return false;  // beyond a pole the image returns from infinity
    const T radial = (T(1.0) + r2 * (lens[4] + r2 * (lens[5] + r2 * lens[8]))) / below;
    const T xy = T(2.0) * x * y;
    pixel[0] = lens[0] * (x * radial + lens[6] * xy + lens[7] * (r2 + T(2.0) * x * x)) + lens[2];
    pixel[1] = lens[1] * (y * radial + lens[6] * (r2 + T(2.0) * y * y) + lens[7] * xy) + lens[3];
    return true;
}

/// `lens` = fx fy cx cy k1 k2 k3 k4.
template <typename T>
bool project_fisheye(const T* lens, const T* p, T* pixel) {
    using std::atan2;
    using std::sqrt;
    const T r2 = p[0] * p[0] + p[1] * p[1];
    // On the axis sqrt has no derivative, and theta / r is 1 / z.
    const bool on_axis = !(r2 > p[2] * p[2] * T(1e-20));
    if (on_axis && !(p[2] > T(0.0))) return false;
    const T r = on_axis ? T(0.0) : T(sqrt(r2));
    const T theta = on_axis ? T(0.0) : T(atan2(r, p[2]));
    const T s = theta * theta;
    const T stretch = T(1.0) + s * (lens[4] + s * (lens[5] + s * (lens[6] + s * lens[7])));
    const T scale = stretch * (on_axis ? T(1.0) / p[2] : theta / r);
    pixel[0] = lens[0] * p[0] * scale + lens[2];
    pixel[1] = lens[1] * p[1] * scale + lens[3];
    return true;
}

}  // namespace surefoot::calibration
