// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::elevation {

/// MotionNoise for a row of cells. The variances are polynomials; y is part of the coefficients:
///   var(dz):     h0 + h1 x + h2 x^2
///   var(dx):     xx0 + xx1 z + xx2 z^2
///   var(dy):     yy0 + yy1 x + yy2 z + yy3 x^2 + yy4 x z + yy5 z^2
///   cov(dx, dy): xy0 + xy1 x + xy2 z + xy3 x z + xy4 z^2
struct MotionPolynomials {
    float h[3];
    float xx[3];
    float yy[6];
    float xy[5];
    float first_x_m;  ///< x of the row's first cell, from the body
    float step_m;
    float body_z_m;  ///< height of the body in odom; z counts from it
};

/// Adds the variances to those of remembered cells; `horizontal_drift_m` is a sigma. Every
/// instruction set gives the same bytes. Unknown cells (NaN) stay unknown.
void blur_cells(const MotionPolynomials& p,
                int cells,
                const float* height_m,
                float* height_var_m2,
                float* horizontal_drift_m);

}  // namespace surefoot::elevation
