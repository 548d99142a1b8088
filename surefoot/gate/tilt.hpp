// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "surefoot/core/machine.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Square root by Newton's method, because the gate calls no libm. Returns 0 for zero and less.
[[nodiscard]] constexpr double root(double square) noexcept {
    if (!(square > 0.0)) return 0.0;
    double value = square > 1.0 ? square : 1.0;
    for (int i = 0; i < 60; ++i) value = 0.5 * (value + square / value);
    return value;
}

/// Tangent of the largest angle between odom's z axis and the vertical: `sigma_factor` sigmas of
/// the snapshot's tilt. Infinite if the tilt is unknown or the angle exceeds 0.5 rad.
[[nodiscard]] constexpr double vertical_bound_tan(const grid::MapSnapshot& map,
                                                  const GateLimits& limits) noexcept {
    constexpr double kRadPerUnit = 1e-6;
    constexpr double kLargest_rad = 0.5;
    if (map.tilt_sigma_urad == grid::MapSnapshot::kUnknownTilt)
        return std::numeric_limits<double>::infinity();
    const double bound_rad =
        limits.sigma_factor * static_cast<double>(map.tilt_sigma_urad) * kRadPerUnit;
    if (!(bound_rad <= kLargest_rad)) return std::numeric_limits<double>::infinity();
    // tan x = x + x^3 / 3 + ... <= x + x^3 / 2 for x <= 1.
    return bound_rad * (1.0 + 0.5 * bound_rad * bound_rad);
}

/// Squared tangent of the steepest possible tilt against the vertical. `tan_sq` is the squared
/// tangent of the ground's tilt against odom's z axis. Uses tan(a + b) = (tan a + tan b) / (1 - tan
/// a tan b). For a bound of zero the result is exactly `tan_sq`. Otherwise it is infinite from a
/// right angle on, and for NaN.
[[nodiscard]] constexpr double steepest_tan_sq(double tan_sq, double bound_tan) noexcept {
    if (bound_tan == 0.0) return tan_sq;
    if (!(tan_sq >= 0.0)) return std::numeric_limits<double>::infinity();  // NaN
    const double tan = root(tan_sq);
    const double rest = 1.0 - tan * bound_tan;
    if (!(rest > 0.0)) return std::numeric_limits<double>::infinity();  // NaN, too
    const double steepest = (tan + bound_tan) / rest;
    return steepest * steepest;
}

/// True if n_z = 1 / sqrt(1 + tan^2) >= the limit. Needs no square root. False for NaN.
[[nodiscard]] constexpr bool keeps_tilt_limit(double tan_sq, const GateLimits& limits) noexcept {
    return limits.min_normal_z * limits.min_normal_z * (1.0 + tan_sq) <= 1.0;
}

}  // namespace surefoot::gate
