// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace surefoot::calibration {

/// Number of rim positions that represent a disc. The error is of sixth order in the radius: 1e-4
/// px for discs that fill half of their cells on a board that fills the image.
inline constexpr int kRimPoints = 8;

/// Rim points of a disc of radius 1, and weights for the derivative with respect to the angle:
/// those of a trigonometric polynomial through values at equal angles (Trefethen, *Spectral methods
/// in MATLAB*, 2000, chapter 3). Every rim point uses the same weights.
struct Rim {
    std::array<double, kRimPoints> x{};
    std::array<double, kRimPoints> y{};
    std::array<double, kRimPoints> slope{};  ///< [k]: weight of the value k positions ahead

    Rim() {
        constexpr double kStep_rad = 2.0 * std::numbers::pi / kRimPoints;
        for (std::size_t i = 0; i < kRimPoints; ++i) {
            const double angle_rad = kStep_rad * static_cast<double>(i);
            x[i] = std::cos(angle_rad);
            y[i] = std::sin(angle_rad);
            if (i == 0) continue;
            const double sign = i % 2 == 0 ? -1.0 : 1.0;
            slope[i] = sign * 0.5 / std::tan(0.5 * angle_rad);
        }
    }
};

/// Computes the centre of gravity of the image of a disc; detectors measure this point. Perspective
/// and lens move it away from the image of the disc's centre. Green's theorem turns area and
/// moments into rim integrals: of u dv - v du (twice the area), u^2 dv and -v^2 du.
///
/// `project(x, y, pixel)` maps a position on a disc of radius 1 into the image, or returns false if
/// it has no image. disc_image then returns false, also for a disc seen edge on.
template <typename T, typename Project>
bool disc_image(const Project& project, T* pixel) {
    static const Rim rim;
    T points[kRimPoints][2];
    T middle[2] = {T(0.0), T(0.0)};
    for (std::size_t i = 0; i < kRimPoints; ++i) {
        if (!project(rim.x[i], rim.y[i], points[i])) return false;
        for (int k = 0; k < 2; ++k) middle[k] += points[i][k] * T(1.0 / kRimPoints);
    }
    for (auto& point : points)
        for (int k = 0; k < 2; ++k) point[k] -= middle[k];
    T twice_area = T(0.0);
    T moment[2] = {T(0.0), T(0.0)};
    for (std::size_t i = 0; i < kRimPoints; ++i) {
        T du = T(0.0);
        T dv = T(0.0);
        for (std::size_t ahead = 1; ahead < kRimPoints; ++ahead) {
            const auto& other = points[(i + ahead) % kRimPoints];
            du += other[0] * T(rim.slope[ahead]);
            dv += other[1] * T(rim.slope[ahead]);
        }
        const T& u = points[i][0];
        const T& v = points[i][1];
        twice_area += u * dv - v * du;
        moment[0] += u * u * dv;
        moment[1] -= v * v * du;
    }
    if (!(twice_area > T(0.0)) && !(twice_area < T(0.0))) return false;
    for (int k = 0; k < 2; ++k) pixel[k] = middle[k] + moment[k] / twice_area;
    return true;
}

}  // namespace surefoot::calibration
