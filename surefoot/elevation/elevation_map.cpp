// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/elevation_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/time.hpp"
#include "surefoot/elevation/depth_points.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Trust in what hangs over a cell: a sighting adds two, seeing the ground below takes one away.
/// Two sightings are believed, one may be a wrong match; what was the cell's height before the
/// ground below it was found is believed longest. ASSUMPTION, all three.
constexpr int kOverheadSeen = 2;
constexpr int kOverheadSure = 4;
constexpr int kOverheadMost = 8;

/// Calls `f(layer, value of an unknown cell)` for every layer.
template <typename F>
void for_each_layer(ElevationLayers& layers,
                    grid::Layer& settled_var_m2,
                    Image<ViewpointHistory::Id>& viewpoint,
                    grid::Layer& overhead_m,
                    Image<std::uint8_t>& overhead_trust,
                    const F& f) {
    f(layers.height_m, kNan);
    f(layers.height_var_m2, kNan);
    f(layers.count, std::uint32_t{0});
    f(layers.seen_ns, std::int64_t{0});
    f(layers.horizontal_drift_m, kNan);
    f(layers.highest_m, kNan);
    f(layers.lowest_m, kNan);
    f(layers.clearance_m, kNan);
    f(settled_var_m2, kNan);
    f(viewpoint, ViewpointHistory::kNever);
    f(overhead_m, kNan);
    f(overhead_trust, std::uint8_t{0});
}

}  // namespace

ElevationMap::ElevationMap(const ElevationConfig& config)
    : config_(config), window_(config.length_m, config.resolution_m), views_(config.viewpoint) {
    SUREFOOT_ASSERT(!config.problem());
    for_each_layer(layers_,
                   settled_var_m2_,
                   viewpoint_,
                   overhead_m_,
                   overhead_trust_,
                   [&](auto& layer, auto unknown) {
                       layer.resize(geometry().nx, geometry().ny);
                       layer.fill(unknown);
                   });
}

void ElevationMap::clear() {
    for_each_layer(layers_,
                   settled_var_m2_,
                   viewpoint_,
                   overhead_m_,
                   overhead_trust_,
                   [](auto& layer, auto unknown) { layer.fill(unknown); });
}

std::int64_t ElevationMap::known_cells() const noexcept {
    const grid::Layer& height_m = layers_.height_m;
    return std::count_if(height_m.data(), height_m.data() + height_m.size(), [](float h_m) {
        return !std::isnan(h_m);
    });
}

void ElevationMap::follow(const Pose& T_odom_body, const Matrix6& relative_covariance) {
    const MotionNoise noise(relative_covariance, T_odom_body.R());
    if (!T_odom_body.all_finite() || !noise.is_finite()) {
        clear();
        return;
    }
    shift(window_.center_on(T_odom_body.translation_m.x(), T_odom_body.translation_m.y()));
    if (!noise.is_zero()) inflate(noise, T_odom_body.translation_m);
}

void ElevationMap::shift(grid::Shift shift) {
    if (shift.is_zero()) return;
    for_each_layer(layers_,
                   settled_var_m2_,
                   viewpoint_,
                   overhead_m_,
                   overhead_trust_,
                   [&](auto& layer, auto unknown) { grid::shift_layer(layer, shift, unknown); });
}

void ElevationMap::inflate(const MotionNoise& noise, const Eigen::Vector3d& body_m) {
    for (int iy = 0; iy < geometry().ny; ++iy) {
        const float* height_m = layers_.height_m.row(iy);
        float* var_m2 = layers_.height_var_m2.row(iy);
        float* drift_m = layers_.horizontal_drift_m.row(iy);
        for (int ix = 0; ix < geometry().nx; ++ix) {
            if (std::isnan(height_m[ix])) continue;
            const Eigen::Vector2d r_m = geometry().center_m({ix, iy}) - body_m.head<2>();
            const double z_m = static_cast<double>(height_m[ix]) - body_m.z();
            var_m2[ix] += static_cast<float>(noise.height_var_m2(r_m.x(), r_m.y()));
            const double more_m2 = noise.horizontal_var_m2(r_m.x(), r_m.y(), z_m);
            drift_m[ix] = std::sqrt(drift_m[ix] * drift_m[ix] + static_cast<float>(more_m2));
        }
    }
}

FusionCounts ElevationMap::add(const camera::RectifiedRig& rig,
                               const Pose& T_odom_body,
                               const camera::DepthImage& depth,
                               std::int64_t time_ns) {
    FusionCounts counts;
    if (!T_odom_body.all_finite()) return counts;
    points_from_depth(config_, rig, T_odom_body, depth, geometry().origin_m, points_, counts);
    return fuse_points(T_odom_body, time_ns, counts);
}

FusionCounts ElevationMap::add_points(std::span<const MeasuredPoint> points,
                                      const Pose& T_body_sensor,
                                      const Pose& T_odom_body,
                                      std::int64_t time_ns) {
    FusionCounts counts;
    if (!T_odom_body.all_finite() || !T_body_sensor.all_finite()) return counts;
    points_from_cloud(
        config_, points, T_body_sensor, T_odom_body, geometry().origin_m, points_, counts);
    return fuse_points(T_odom_body, time_ns, counts);
}

FusionCounts ElevationMap::fuse_points(const Pose& T_odom_body,
                                       std::int64_t time_ns,
                                       FusionCounts counts) {
    const PrefilterConfig& cut = config_.prefilter;
    std::span<GridPoint> points = points_;
    if (cut.down_sampling) points = points.first(filter_.down_sample(cut.sampling_m, points));
    if (cut.outlier_removal) {
        const std::size_t kept =
            filter_.remove_outliers(cut.outlier_radius_m, cut.outlier_min_neighbours, points);
        counts.gated_density += static_cast<std::int64_t>(points.size() - kept);
        points = points.first(kept);
    }
    counts.outside += groups_.assign(points, geometry());
    present_view_ = views_.look_from(T_odom_body);
    for (std::size_t cell = 0; cell < layers_.height_m.size(); ++cell) {
        const std::span<HeightSample> samples = groups_.samples(cell);
        if (samples.empty()) continue;
        if (const auto measured = reduce_cell(config_.reduction, samples)) {
            measure(cell, *measured, time_ns, counts);
        }
    }
    return counts;
}

void ElevationMap::measure(std::size_t cell,
                           const CellMeasurement& measured,
                           std::int64_t time_ns,
                           FusionCounts& counts) {
    ++counts.cells_measured;
    const float height_m = layers_.height_m.data()[cell];
    if (std::isnan(height_m)) {
        ++counts.cells_new;
        start(cell, measured, time_ns);
        return;
    }
    float& var_m2 = layers_.height_var_m2.data()[cell];
    const FusionResult result =
        fuse(config_.fusion,
             {static_cast<double>(height_m), static_cast<double>(var_m2)},
             {static_cast<double>(measured.z_m), static_cast<double>(measured.var_m2)},
             is_same_scan(time_ns - layers_.seen_ns.data()[cell]));
    if (result.outcome == FusionOutcome::fused) {
        ++counts.cells_fused;
        agree(cell, result.cell, measured, time_ns);
        return;
    }
    ++counts.cells_inflated;
    const auto hangs = static_cast<float>(config_.min_overhead_m);
    if (result.outcome == FusionOutcome::replaced) {
        start(cell, measured, time_ns);
        if (height_m - measured.z_m > hangs) see_above(cell, height_m, kOverheadMost);
    }
    if (result.outcome == FusionOutcome::inflated) {
        var_m2 = static_cast<float>(result.cell.var_m2);
        if (measured.z_m - height_m > hangs) see_above(cell, measured.z_m, kOverheadSeen);
    }
}

void ElevationMap::see_above(std::size_t cell, float z_m, int trust) {
    float& overhead_m = overhead_m_.data()[cell];
    overhead_m = std::isnan(overhead_m) ? z_m : std::min(overhead_m, z_m);
    std::uint8_t& believed = overhead_trust_.data()[cell];
    believed = static_cast<std::uint8_t>(std::min(believed + trust, kOverheadMost));
    set_clearance(cell);
}

void ElevationMap::see_no_more_above(std::size_t cell) {
    std::uint8_t& believed = overhead_trust_.data()[cell];
    if (believed == 0) return;
    --believed;
    if (believed == 0) overhead_m_.data()[cell] = kNan;
    set_clearance(cell);
}

void ElevationMap::set_clearance(std::size_t cell) {
    const bool sure = overhead_trust_.data()[cell] >= kOverheadSure;
    const float free_m = overhead_m_.data()[cell] - layers_.height_m.data()[cell];
    layers_.clearance_m.data()[cell] = sure ? free_m : kNan;
}

bool ElevationMap::is_same_scan(std::int64_t since_seen_ns) const {
    const double duration_s = config_.fusion.scan_duration_s;
    return duration_s > 0.0 && since_seen_ns <= ns_from_seconds(duration_s);
}

void ElevationMap::start(std::size_t cell, const CellMeasurement& measured, std::int64_t time_ns) {
    const auto floor_m2 = static_cast<float>(config_.fusion.min_height_var_m2);
    layers_.height_m.data()[cell] = measured.z_m;
    layers_.height_var_m2.data()[cell] = std::max(measured.var_m2, floor_m2);
    layers_.count.data()[cell] = 1;
    layers_.seen_ns.data()[cell] = time_ns;
    layers_.horizontal_drift_m.data()[cell] = 0.0F;
    layers_.highest_m.data()[cell] = measured.highest_m;
    layers_.lowest_m.data()[cell] = measured.lowest_m;
    layers_.clearance_m.data()[cell] = kNan;
    overhead_m_.data()[cell] = kNan;
    overhead_trust_.data()[cell] = 0;
    settled_var_m2_.data()[cell] = layers_.height_var_m2.data()[cell];
    viewpoint_.data()[cell] = present_view_;
}

void ElevationMap::agree(std::size_t cell,
                         const Height& fused,
                         const CellMeasurement& measured,
                         std::int64_t time_ns) {
    if (views_.is_new_since(viewpoint_.data()[cell])) {
        layers_.height_m.data()[cell] = static_cast<float>(fused.z_m);
        layers_.height_var_m2.data()[cell] = static_cast<float>(fused.var_m2);
        settled_var_m2_.data()[cell] = static_cast<float>(fused.var_m2);
        viewpoint_.data()[cell] = present_view_;
    } else {
        repeat(cell, measured);
    }
    ++layers_.count.data()[cell];
    layers_.seen_ns.data()[cell] = time_ns;
    layers_.horizontal_drift_m.data()[cell] = 0.0F;
    float& highest_m = layers_.highest_m.data()[cell];
    float& lowest_m = layers_.lowest_m.data()[cell];
    highest_m = std::max(highest_m, measured.highest_m);
    lowest_m = std::min(lowest_m, measured.lowest_m);
    see_no_more_above(cell);
}

void ElevationMap::repeat(std::size_t cell, const CellMeasurement& measured) {
    // The cell and the measurement share an unknown part of their errors. Covariance intersection
    // (Julier and Uhlmann 1997) in one dimension: keep whichever is surer, gain nothing.
    float& var_m2 = layers_.height_var_m2.data()[cell];
    float& settled_m2 = settled_var_m2_.data()[cell];
    const float measured_m2 = std::max(measured.var_m2, settled_m2);
    if (var_m2 <= measured_m2) return;
    layers_.height_m.data()[cell] = measured.z_m;
    var_m2 = measured_m2;
    settled_m2 = measured_m2;
    viewpoint_.data()[cell] = present_view_;
}

}  // namespace surefoot::elevation
