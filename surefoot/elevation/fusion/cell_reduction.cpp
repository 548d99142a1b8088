// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/cell_reduction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace surefoot::elevation {
namespace {

/// Sum in sixteen columns: sample i goes into column i modulo 16.
class LaneSum {
  public:
    void add(std::size_t index, float value) noexcept { column_[index % 16] += value; }
    [[nodiscard]] float total() const noexcept { return tree(column_); }

  private:
    float column_[16] = {};
};

/// Returns the height with `rank` samples at or above it (rank 1 = the maximum). Adding 0 removes
/// the sign of zero.
float upper_quantile(std::vector<float> z_m, int rank) {
    const auto nth = z_m.begin() + (rank - 1);
    std::nth_element(z_m.begin(), nth, z_m.end(), std::greater<>());
    return *nth + 0.0F;
}

Surface surface_around(std::span<const float> z_m,
                       std::span<const float> var_m2,
                       float center_m,
                       float half_width_m) {
    int points = 0;
    LaneSum sum_m;
    LaneSum sum_sq_m2;
    LaneSum sum_var_m2;
    for (std::size_t i = 0; i < z_m.size(); ++i) {
        const float offset_m = z_m[i] - center_m;
        if (std::abs(offset_m) > half_width_m) continue;
        ++points;
        sum_m.add(i, offset_m);
        sum_sq_m2.add(i, offset_m * offset_m);
        sum_var_m2.add(i, var_m2[i]);
    }
    if (points == 0) return {};
    return surface_of(points, center_m, sum_m.total(), sum_sq_m2.total(), sum_var_m2.total());
}

Surface climb(std::span<const float> z_m,
              std::span<const float> var_m2,
              float start_m,
              float half_width_m) {
    Surface surface = surface_around(z_m, var_m2, start_m, half_width_m);
    for (int round = 1; round < kClimbs && surface.points > 0; ++round) {
        surface = surface_around(z_m, var_m2, surface.mean_m, half_width_m);
    }
    return surface;
}

float mean_variance(std::span<const float> var_m2) {
    LaneSum sum_m2;
    for (std::size_t i = 0; i < var_m2.size(); ++i) sum_m2.add(i, var_m2[i]);
    return sum_m2.total() / static_cast<float>(var_m2.size());
}

}  // namespace

CellMeasurement face_of(const ReductionConfig& config,
                        const CellMeasurement& seen,
                        int points,
                        float half_width_m) noexcept {
    if (points < config.min_face_points) return {};
    CellMeasurement face = seen;
    face.z_m = seen.highest_m;
    face.var_m2 = half_width_m * half_width_m;
    face.points = points;
    return face;
}

void ReductionConfig::describe(ConfigVisitor& visitor) {
    visitor.integer("min_points",
                    min_points,
                    1,
                    10000,
                    "smallest number of points on one surface of a cell that give a measurement");
    visitor.number("upper_share",
                   upper_share,
                   0.0,
                   1.0,
                   "smallest share of a cell's points that its highest surface needs");
    visitor.number("window_sigma",
                   window_sigma,
                   0.1,
                   100.0,
                   "largest distance of a point from the surface to which it belongs [sigma of the "
                   "cell's points]; surface_relief_m is added");
    visitor.number(
        "surface_relief_m",
        surface_relief_m,
        0.0,
        1.0,
        "height range of the ground within one cell; added to the distance that window_sigma "
        "allows");
    visitor.number("points_per_independent",
                   points_per_independent,
                   1.0,
                   1e6,
                   "number of points that share one error, in one cell and frame");
    visitor.number("max_independent",
                   max_independent,
                   1.0,
                   1e6,
                   "largest number of independent errors in one cell and frame");
    visitor.integer(
        "min_face_points",
        min_face_points,
        1,
        1000000,
        "a cell without a common height is a vertical face if it has at least this many points");
    visitor.number(
        "systematic_sigma_m",
        systematic_sigma_m,
        0.0,
        1.0,
        "one sigma of the calibration and lattice errors in every measurement of a cell");
    visitor.number("border_share",
                   border_share,
                   0.0,
                   1.0,
                   "smallest number of points in a cell at the image border, as a share of the "
                   "points that level ground would give; 0 = min_points is enough");
}

std::optional<CellMeasurement> reduce_cell(const ReductionConfig& config,
                                           std::span<const float> z_m,
                                           std::span<const float> var_m2) {
    const auto n = static_cast<int>(z_m.size());
    const int support = support_of(config, n);
    if (n < support) return std::nullopt;

    const std::vector<float> all_m(z_m.begin(), z_m.end());
    CellMeasurement measurement;
    measurement.lowest_m = upper_quantile(all_m, n - support + 1);
    measurement.highest_m = upper_quantile(all_m, support);
    const float half_width_m = half_width(config, mean_variance(var_m2));
    float start_m = measurement.highest_m;
    int rank = support;
    for (int attempt = 0; attempt < kMaxTries; ++attempt) {
        const Surface surface = climb(z_m, var_m2, start_m, half_width_m);
        if (surface.points >= support) {
            measurement.z_m = surface.mean_m;
            measurement.var_m2 = measurement_variance(config, surface);
            measurement.points = surface.points;
            return measurement;
        }
        rank += support;
        if (rank > n) break;
        start_m = upper_quantile(all_m, rank);
    }
    const CellMeasurement face = face_of(config, measurement, n, half_width_m);
    return face.points > 0 ? std::optional(face) : std::nullopt;
}

}  // namespace surefoot::elevation
