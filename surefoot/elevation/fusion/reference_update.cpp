// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/reference_update.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/fusion/height_fusion.hpp"
#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void ReferenceConfig::describe(ConfigVisitor& visitor) {
    visitor.number("resolution_m", resolution_m, 0.001, 10.0, "side length of a map cell");
    visitor.number("length_m", length_m, 0.01, 1000.0, "side length of the square map");
    visitor.number("start_x_m", start_x_m, -1e6, 1e6, "x of the map centre before the first step");
    visitor.number("start_y_m", start_y_m, -1e6, 1e6, "y of the map centre before the first step");
    visitor.number("start_time_s",
                   start_time_s,
                   -1e12,
                   1e12,
                   "start time of the map; the time layer holds seconds since this time");
    visitor.number("min_variance_m2",
                   min_variance_m2,
                   0.0,
                   100.0,
                   "smallest variance of a cell; smaller variances are raised to this value");
    visitor.number("max_variance_m2",
                   max_variance_m2,
                   0.0,
                   100.0,
                   "largest variance of a cell; a larger variance becomes infinite, and the next "
                   "point overwrites the cell");
    visitor.number("mahalanobis_threshold",
                   mahalanobis_threshold,
                   0.0,
                   100.0,
                   "largest distance of a point from the cell height that passes the gate "
                   "[standard deviations of the cell]");
    visitor.number("multi_height_noise_m2",
                   multi_height_noise_m2,
                   0.0,
                   100.0,
                   "amount added to the variance of a cell when the gate rejects a point");
    visitor.number("scanning_duration_s",
                   scanning_duration_s,
                   0.0,
                   1000.0,
                   "time within which points of one cell belong to one scan; the upper point of a "
                   "scan is kept");
    visitor.number(
        "increase_height_alpha",
        increase_height_alpha,
        0.0,
        1.0,
        "share of the old height that remains when a higher point of the same scan replaces it");
}

ReferenceMap::ReferenceMap(const ReferenceConfig& config) : config_(config) {
    const int cells = std::max(1, grid::nearest_cells(config.length_m, config.resolution_m));
    geometry_.resolution_m = config.resolution_m;
    geometry_.nx = cells;
    geometry_.ny = cells;
    place({config.start_x_m, config.start_y_m});
    elevation_m_ = grid::SlidingLayer<float>(cells, cells, kNanF);
    variance_m2_ = grid::SlidingLayer<float>(cells, cells, kNanF);
    time_s_ = grid::SlidingLayer<float>(cells, cells, kNanF);
}

void ReferenceMap::place(const Eigen::Vector2d& position_m) {
    position_m_ = position_m;
    const double half_m = 0.5 * geometry_.nx * geometry_.resolution_m;
    geometry_.origin_m = position_m - Eigen::Vector2d::Constant(half_m);
}

void ReferenceMap::move_to(double x_m, double y_m) {
    if (!std::isfinite(x_m) || !std::isfinite(y_m)) return;
    const grid::Shift shift{grid::nearest_cells(x_m - position_m_.x(), geometry_.resolution_m),
                            grid::nearest_cells(y_m - position_m_.y(), geometry_.resolution_m)};
    place(position_m_ + geometry_.resolution_m * Eigen::Vector2d(shift.dx, shift.dy));
    for (grid::SlidingLayer<float>* layer : {&elevation_m_, &variance_m2_, &time_s_}) {
        layer->shift(shift, kNanF);
    }
}

void ReferenceMap::add(std::span<const ReferencePoint> cloud, double time_s) {
    const auto since_start_s = static_cast<float>(time_s - config_.start_time_s);
    for (const ReferencePoint& point : cloud) add_point(point, since_start_s);
    bound_variances();
}

void ReferenceMap::add_point(const ReferencePoint& point, float time_s) {
    // The reference implementation numbers cells from the corner of largest x and y. So a point
    // on a border between two cells belongs to the cell with the smaller coordinates.
    const double length_m = geometry_.nx * geometry_.resolution_m;
    const Eigen::Vector2d down_m =
        position_m_ + Eigen::Vector2d::Constant(0.5 * length_m) -
        Eigen::Vector2d(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    if (!(down_m.minCoeff() >= 0.0 && down_m.maxCoeff() < length_m)) return;
    // in range: both lie in [0, length_m), which is nx cells
    const int ix = geometry_.nx - 1 - static_cast<int>(down_m.x() / geometry_.resolution_m);
    // in range: as ix
    const int iy = geometry_.ny - 1 - static_cast<int>(down_m.y() / geometry_.resolution_m);
    if (!geometry_.contains({ix, iy})) return;

    float& elevation_m = elevation_m_.row(iy)[ix];
    float& variance_m2 = variance_m2_.row(iy)[ix];
    float& cell_time_s = time_s_.row(iy)[ix];
    if (!std::isfinite(elevation_m) || !std::isfinite(variance_m2)) {
        elevation_m = point.z_m;
        variance_m2 = point.variance_m2;
        return;
    }
    const double threshold_sq = config_.mahalanobis_threshold * config_.mahalanobis_threshold;
    const Height cell{static_cast<double>(elevation_m), static_cast<double>(variance_m2)};
    if (mahalanobis_sq(cell, {static_cast<double>(point.z_m), 0.0}) > threshold_sq) {
        disagree(point, time_s, elevation_m, variance_m2, cell_time_s);
        return;
    }
    // Equation (6.1) of Lange 2016 in float32.
    const float sum_m2 = variance_m2 + point.variance_m2;
    elevation_m = (variance_m2 * point.z_m + point.variance_m2 * elevation_m) / sum_m2;
    variance_m2 = point.variance_m2 * variance_m2 / sum_m2;
    cell_time_s = time_s;
}

void ReferenceMap::disagree(const ReferencePoint& point,
                            float time_s,
                            float& elevation_m,
                            float& variance_m2,
                            float cell_time_s) const {
    const bool same_scan =  // false for a cell without a time
        static_cast<double>(time_s - cell_time_s) <= config_.scanning_duration_s;
    if (!same_scan) {
        variance_m2 += static_cast<float>(config_.multi_height_noise_m2);
        return;
    }
    if (point.z_m < elevation_m) return;
    const auto old_share = static_cast<float>(config_.increase_height_alpha);
    elevation_m = old_share * elevation_m + (1.0F - old_share) * point.z_m;
    variance_m2 = old_share * variance_m2 + (1.0F - old_share) * point.variance_m2;
}

void ReferenceMap::bound_variances() {
    const auto min_m2 = static_cast<float>(config_.min_variance_m2);
    const auto max_m2 = static_cast<float>(config_.max_variance_m2);
    for (float* v = variance_m2_.data(); v != variance_m2_.data() + variance_m2_.size(); ++v) {
        if (*v < min_m2) *v = min_m2;
        if (*v > max_m2) *v = kInfinity;
    }
}

std::vector<FuseStepResult> run_fuse_steps(const ReferenceConfig& config,
                                           std::span<const FuseStep> steps) {
    ReferenceMap map(config);
    std::vector<FuseStepResult> results;
    results.reserve(steps.size());
    for (const FuseStep& step : steps) {
        map.move_to(step.move_x_m, step.move_y_m);
        map.add(step.cloud, step.time_s);
        results.push_back({map.geometry(),
                           map.elevation_m().copy(),
                           map.variance_m2().copy(),
                           map.time_s().copy()});
    }
    return results;
}

}  // namespace surefoot::elevation
