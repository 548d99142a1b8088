// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "surefoot/core/config.hpp"

namespace surefoot::elevation {

/// Settings for the reduction of the points of one frame in one cell to one measurement.
struct ReductionConfig {
    int min_points = 3;              ///< fewer points on one surface give no measurement
    double upper_share = 0.1;        ///< smallest share of a cell's points on its upper surface
    double window_sigma = 2.5;       ///< largest distance of a point from its surface [sigma]
    double surface_relief_m = 0.01;  ///< added to that distance: height range of ground in a cell
    /// Errors of a semi-global matcher are correlated over more pixels than a cell covers: we
    /// measured 1.0-1.3 independent errors per cell and frame (docs/lab/correlated_depth.md).
    double points_per_independent = 30.0;
    double max_independent = 1.0;
    /// This many points without a common height are a vertical face, seen from the side.
    int min_face_points = 60;
    double systematic_sigma_m = 0.002;  ///< calibration and lattice errors, in every measurement
    /// A cell that reaches beyond the image needs this share of the points of level ground. A point
    /// from outside the image reaches the cell only if its error points inwards. With a standing
    /// camera such points collect, and the ground looks 15 mm too high there (ZED, 1.2 m away).
    double border_share = 0.75;

    void describe(ConfigVisitor& visitor);
};

/// Measurement of one cell by one frame.
struct CellMeasurement {
    float z_m = 0.0F;  ///< height of the highest surface that enough points share
    float var_m2 = 0.0F;
    float highest_m = 0.0F;  ///< robust extremes of all points in the cell
    float lowest_m = 0.0F;
    int points = 0;  ///< number of points on that surface
};

/// Finds the highest surface among the samples of a cell. The search starts at an upper quantile of
/// the heights, so single outliers do not count. It climbs to the centre of the points around the
/// start (mean shift). If too few points share that height, it tries the next lower start. The
/// variance is the sum of two parts. One is the systematic part. The other is the larger of mean
/// variance and scatter, divided by the number of independent errors. Many points without a common
/// height are a vertical face (a wall, a person) with the height of the upper quantile; few such
/// points give no result. `z_m` and `var_m2` must be finite and of equal length.
///
/// This is the reference version; `reduce_cells` gives the same bytes.
[[nodiscard]] std::optional<CellMeasurement> reduce_cell(const ReductionConfig& config,
                                                         std::span<const float> z_m,
                                                         std::span<const float> var_m2);

// Parts that both `reduce_cell` and `reduce_cells` use.

inline constexpr int kClimbs = 3;    ///< mean-shift steps; 3 leave an error of a few % of a window
inline constexpr int kMaxTries = 4;  ///< largest number of start heights that are tried per cell

/// Returns the number of points that a surface needs in a cell of `n` points.
[[nodiscard]] inline int support_of(const ReductionConfig& config, int n) noexcept {
    // in range: describe() keeps upper_share in [0, 1], so this is at most n
    return std::max({1, static_cast<int>(std::ceil(config.upper_share * n)), config.min_points});
}

/// Returns the half width of the window around a surface.
[[nodiscard]] inline float half_width(const ReductionConfig& config, float mean_var_m2) noexcept {
    return static_cast<float>(config.window_sigma * std::sqrt(static_cast<double>(mean_var_m2)) +
                              config.surface_relief_m);
}

/// The points within a window around a height.
struct Surface {
    int points = 0;
    float mean_m = 0.0F;
    float mean_var_m2 = 0.0F;
    float scatter_m2 = 0.0F;
};

/// Computes a surface from sums over `points` > 0 points. `sum_m`: offsets from the centre.
/// `sum_sq_m2`: squares of these offsets. `sum_var_m2`: variances.
[[nodiscard]] inline Surface surface_of(
    int points, float center_m, float sum_m, float sum_sq_m2, float sum_var_m2) noexcept {
    const auto n = static_cast<float>(points);
    Surface surface{points, center_m + sum_m / n, sum_var_m2 / n, 0.0F};
    if (points > 1) {
        surface.scatter_m2 = std::max(0.0F, (sum_sq_m2 - sum_m * sum_m / n) / (n - 1.0F));
    }
    return surface;
}

[[nodiscard]] inline float measurement_variance(const ReductionConfig& config,
                                                const Surface& surface) noexcept {
    const double independent = std::max(
        1.0, std::min(surface.points / config.points_per_independent, config.max_independent));
    const auto spread_m2 = static_cast<double>(std::max(surface.mean_var_m2, surface.scatter_m2));
    return static_cast<float>(spread_m2 / independent +
                              config.systematic_sigma_m * config.systematic_sigma_m);
}

/// Returns the result for a cell without a surface of enough points: a vertical face, or 0 points.
/// `seen` holds the extremes.
[[nodiscard]] CellMeasurement face_of(const ReductionConfig& config,
                                      const CellMeasurement& seen,
                                      int points,
                                      float half_width_m) noexcept;

/// Returns the sum of sixteen columns. The order of the additions is always the same.
[[nodiscard]] constexpr float tree(const float column[16]) noexcept {
    float four[4] = {};
    for (int i = 0; i < 4; ++i) {
        four[i] = (column[i] + column[i + 8]) + (column[i + 4] + column[i + 12]);
    }
    return (four[0] + four[2]) + (four[1] + four[3]);
}

}  // namespace surefoot::elevation
