// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace surefoot::camera {

/// Whether the polynomial sum c[i] s^i is positive everywhere on [0, s_max]; at most 8
/// coefficients. Lens models ask it of the derivative of their distortion: beyond the first root
/// the image folds back, and far-off-axis points would appear inside the picture.
///
/// Method: a polynomial lies between the smallest and largest of its Bernstein coefficients
/// (Farouki 2012, section 4); where these have both signs the interval is halved. False when NaN is
/// involved or when the question stays open after 40 halvings (the polynomial touches zero).
[[nodiscard]] bool positive_on(std::span<const double> coefficients, double s_max) noexcept;

}  // namespace surefoot::camera
