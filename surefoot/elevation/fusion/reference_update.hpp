// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/grid/sliding_layer.hpp"

namespace surefoot::elevation {

/// Parameters of the elevation update of the reference implementation (ETH elevation_mapping); the
/// defaults are those of the preset `ethz`.
struct ReferenceConfig {
    double resolution_m = 0.05;
    double length_m = 2.0;
    double start_x_m = 0.0;
    double start_y_m = 0.0;
    double start_time_s = 1000.0;  ///< the time layer counts from this time
    double min_variance_m2 = 9e-6;
    double max_variance_m2 = 0.009;
    double mahalanobis_threshold = 2.5;
    double multi_height_noise_m2 = 9e-6;
    double scanning_duration_s = 0.05;
    double increase_height_alpha = 0.0;  ///< share of the old height when a higher one replaces it

    void describe(ConfigVisitor& visitor);
};

struct ReferencePoint {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float z_m = 0.0F;
    float variance_m2 = 0.0F;
};
static_assert(sizeof(ReferencePoint) == 16, "the files hold four float32 per point");

/// Elevation update of the reference implementation, for comparison only; the live chain does not
/// use it. It differs from ElevationMap. Every point updates its cell in file order and in
/// float32. The gate uses the cell's variance only. A variance above the maximum becomes infinite,
/// and the next point overwrites the cell. The first measurement of a cell sets no time, so an
/// outlier right after it always adds noise. Horizontal variances do not act on heights and are
/// left out.
///
/// Grids are in our order: column = ix along +x, row = iy along +y.
class ReferenceMap {
  public:
    explicit ReferenceMap(const ReferenceConfig& config);

    /// Moves the map by whole cells. Half a cell rounds away from zero. New cells are NaN in all
    /// layers.
    void move_to(double x_m, double y_m);
    void add(std::span<const ReferencePoint> cloud, double time_s);

    [[nodiscard]] const grid::GridGeometry& geometry() const noexcept { return geometry_; }
    [[nodiscard]] const grid::SlidingLayer<float>& elevation_m() const noexcept {
        return elevation_m_;
    }
    [[nodiscard]] const grid::SlidingLayer<float>& variance_m2() const noexcept {
        return variance_m2_;
    }
    [[nodiscard]] const grid::SlidingLayer<float>& time_s() const noexcept {
        return time_s_;
    }  ///< seconds since `start_time_s`

  private:
    void add_point(const ReferencePoint& point, float time_s);
    void disagree(const ReferencePoint& point,
                  float time_s,
                  float& elevation_m,
                  float& variance_m2,
                  float cell_time_s) const;
    void bound_variances();
    void place(const Eigen::Vector2d& position_m);

    ReferenceConfig config_;
    grid::GridGeometry geometry_;
    Eigen::Vector2d position_m_;  ///< centre of the map
    grid::SlidingLayer<float> elevation_m_;
    grid::SlidingLayer<float> variance_m2_;
    grid::SlidingLayer<float> time_s_;
};

/// One line of a steps file: the map moves, then takes a cloud.
struct FuseStep {
    double time_s = 0.0;
    double move_x_m = 0.0;
    double move_y_m = 0.0;
    std::vector<ReferencePoint> cloud;
};

/// The map after one step.
struct FuseStepResult {
    grid::GridGeometry geometry;
    grid::Layer elevation_m;
    grid::Layer variance_m2;
    grid::Layer time_s;
};

/// Runs all steps on a fresh map and returns the map after each of them.
[[nodiscard]] std::vector<FuseStepResult> run_fuse_steps(const ReferenceConfig& config,
                                                         std::span<const FuseStep> steps);

}  // namespace surefoot::elevation
