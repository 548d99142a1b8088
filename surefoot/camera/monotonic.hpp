// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace surefoot::camera {

/// True if the polynomial sum c[i] s^i (at most 8 coefficients) is positive on all of [0, s_max].
/// Lens models apply it to the derivative of their distortion. Beyond the first root the image
/// folds back, and points far off the axis would appear inside the picture.
///
/// Method: a polynomial lies between its smallest and largest Bernstein coefficients (Farouki 2012,
/// section 4). If the coefficients have both signs, the interval is halved. Returns false for NaN,
/// and if 40 halvings give no decision (the polynomial touches zero).
[[nodiscard]] bool positive_on(std::span<const double> coefficients, double s_max) noexcept;

}  // namespace surefoot::camera
