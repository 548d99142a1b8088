// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/cell_reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace surefoot::elevation {
namespace {

constexpr std::uint32_t kOutside = std::numeric_limits<std::uint32_t>::max();
constexpr int kClimbs = 3;    ///< mean shift settles to a few percent of its window in three rounds
constexpr int kMaxTries = 4;  ///< lower starts before a cell counts as pure scatter

/// Sums over the samples within a window around a height.
struct Surface {
    int points = 0;
    float mean_m = 0.0F;
    float mean_var_m2 = 0.0F;
    float scatter_m2 = 0.0F;
};

/// Height with `rank` samples at or above it (rank 1 = the maximum).
float upper_quantile(std::span<HeightSample> samples, std::size_t rank) {
    const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(
        samples.begin(), nth, samples.end(), [](const HeightSample& a, const HeightSample& b) {
            return a.z_m > b.z_m;
        });
    return nth->z_m;
}

Surface surface_around(std::span<const HeightSample> samples, float center_m, float half_width_m) {
    Surface surface;
    float sum_m = 0.0F;
    float sum_sq_m2 = 0.0F;
    float sum_var_m2 = 0.0F;
    for (const HeightSample& sample : samples) {
        const float offset_m = sample.z_m - center_m;
        if (std::abs(offset_m) > half_width_m) continue;
        ++surface.points;
        sum_m += offset_m;
        sum_sq_m2 += offset_m * offset_m;
        sum_var_m2 += sample.var_m2;
    }
    if (surface.points == 0) return surface;
    const auto n = static_cast<float>(surface.points);
    surface.mean_m = center_m + sum_m / n;
    surface.mean_var_m2 = sum_var_m2 / n;
    if (surface.points > 1) {
        surface.scatter_m2 = std::max(0.0F, (sum_sq_m2 - sum_m * sum_m / n) / (n - 1.0F));
    }
    return surface;
}

Surface climb(std::span<const HeightSample> samples, float start_m, float half_width_m) {
    Surface surface = surface_around(samples, start_m, half_width_m);
    for (int round = 1; round < kClimbs && surface.points > 0; ++round) {
        surface = surface_around(samples, surface.mean_m, half_width_m);
    }
    return surface;
}

float mean_variance(std::span<const HeightSample> samples) {
    float sum_m2 = 0.0F;
    for (const HeightSample& sample : samples) sum_m2 += sample.var_m2;
    return sum_m2 / static_cast<float>(samples.size());
}

float measurement_variance(const ReductionConfig& config, const Surface& surface) {
    const double independent = std::max(
        1.0, std::min(surface.points / config.points_per_independent, config.max_independent));
    const auto spread_m2 = static_cast<double>(std::max(surface.mean_var_m2, surface.scatter_m2));
    return static_cast<float>(spread_m2 / independent +
                              config.systematic_sigma_m * config.systematic_sigma_m);
}

}  // namespace

void ReductionConfig::describe(ConfigVisitor& visitor) {
    visitor.integer("min_points",
                    min_points,
                    1,
                    10000,
                    "fewer points on one surface of a cell are no measurement");
    visitor.number("upper_share",
                   upper_share,
                   0.0,
                   1.0,
                   "share of a cell's points that its highest surface needs");
    visitor.number("window_sigma",
                   window_sigma,
                   0.1,
                   100.0,
                   "points this close to a surface belong to it [sigma of a point] ...");
    visitor.number("surface_relief_m",
                   surface_relief_m,
                   0.0,
                   1.0,
                   "... plus this, for the relief of the ground within a cell");
    visitor.number("points_per_independent",
                   points_per_independent,
                   1.0,
                   1e6,
                   "points of a cell and frame that share one error");
    visitor.number("max_independent",
                   max_independent,
                   1.0,
                   1e6,
                   "largest number of independent errors in a cell and frame");
    visitor.number("systematic_sigma_m",
                   systematic_sigma_m,
                   0.0,
                   1.0,
                   "calibration and lattice errors in every measurement of a cell");
}

std::optional<CellMeasurement> reduce_cell(const ReductionConfig& config,
                                           std::span<HeightSample> samples) {
    const std::size_t n = samples.size();
    const auto share =
        static_cast<std::size_t>(std::ceil(config.upper_share * static_cast<double>(n)));
    const std::size_t support =
        std::max<std::size_t>({1, share, static_cast<std::size_t>(std::max(0, config.min_points))});
    if (n < support) return std::nullopt;

    CellMeasurement measurement;
    measurement.lowest_m = upper_quantile(samples, n - support + 1);
    measurement.highest_m = upper_quantile(samples, support);
    const auto half_width_m = static_cast<float>(
        config.window_sigma * std::sqrt(static_cast<double>(mean_variance(samples))) +
        config.surface_relief_m);
    float start_m = measurement.highest_m;
    std::size_t rank = support;
    for (int attempt = 0; attempt < kMaxTries; ++attempt) {
        const Surface surface = climb(samples, start_m, half_width_m);
        if (surface.points >= static_cast<int>(support)) {
            measurement.z_m = surface.mean_m;
            measurement.var_m2 = measurement_variance(config, surface);
            measurement.points = surface.points;
            return measurement;
        }
        rank += support;
        if (rank > n) return std::nullopt;
        start_m = upper_quantile(samples, rank);
    }
    return std::nullopt;
}

std::int64_t CellGroups::assign(std::span<const GridPoint> points,
                                const grid::GridGeometry& geometry) {
    const auto cells =
        static_cast<std::size_t>(geometry.nx) * static_cast<std::size_t>(geometry.ny);
    const auto per_m = static_cast<float>(1.0 / geometry.resolution_m);
    const auto nx = static_cast<float>(geometry.nx);
    const auto ny = static_cast<float>(geometry.ny);
    begin_.assign(cells + 1, 0);
    cell_of_.resize(points.size());
    std::int64_t outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float fx = points[i].x_m * per_m;
        const float fy = points[i].y_m * per_m;
        if (!(fx >= 0.0F && fy >= 0.0F && fx < nx && fy < ny)) {  // NaN is outside
            cell_of_[i] = kOutside;
            ++outside;
            continue;
        }
        const std::uint32_t cell =
            static_cast<std::uint32_t>(fy) * static_cast<std::uint32_t>(geometry.nx) +
            static_cast<std::uint32_t>(fx);
        cell_of_[i] = cell;
        ++begin_[cell];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& begin : begin_) total += std::exchange(begin, total);
    samples_.resize(total);
    // Filling moves each begin to its end, which is the next one's begin: shift back afterwards.
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (cell_of_[i] == kOutside) continue;
        samples_[begin_[cell_of_[i]]++] = {points[i].z_m, points[i].var_m2};
    }
    for (std::size_t cell = cells; cell > 0; --cell) begin_[cell] = begin_[cell - 1];
    begin_[0] = 0;
    return outside;
}

}  // namespace surefoot::elevation
