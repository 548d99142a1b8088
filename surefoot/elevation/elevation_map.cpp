// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/elevation_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/cell_row_blocks.hpp"
#include "surefoot/elevation/fusion/reduce_cells.hpp"
#include "surefoot/elevation/region/region_transfer.hpp"
#include "surefoot/elevation/sampling/depth_points.hpp"

namespace surefoot::elevation {
namespace {

/// A cell with more than this many times the points of level ground at its lowest height is a face,
/// seen from the side. The floor under a table top and the top together give at most twice as many.
/// ASSUMPTION.
constexpr float kFaceDensity = 3.0F;

/// Returns the horizontal forward direction of the body; x if the body points straight up or down.
Eigen::Vector2d ahead_of(const Pose& T_odom_body) {
    const Eigen::Vector2d ahead = T_odom_body.R().col(0).head<2>();
    const double length = std::sqrt(ahead.squaredNorm());
    return length > 1e-3 ? Eigen::Vector2d(ahead / length) : Eigen::Vector2d::UnitX();
}

bool has_equal_sizes(const DepthImage& depth) {
    const Image<float>& disparity_px = depth.disparity_px;
    return depth.sigma_px.width() == disparity_px.width() &&
           depth.sigma_px.height() == disparity_px.height() &&
           depth.outlier_probability.width() == disparity_px.width() &&
           depth.outlier_probability.height() == disparity_px.height();
}

/// False if no point gave the measurement, or if its sums left the range of a float. Such a
/// measurement gives neither a height nor a ray endpoint.
bool says_something(const CellMeasurement& measured) {
    return measured.points > 0 && std::isfinite(measured.z_m) && std::isfinite(measured.var_m2);
}

}  // namespace

ElevationMap::ElevationMap(const ElevationConfig& config)
    : config_(config),
      window_(config.length_m, config.resolution_m),
      views_(config.viewpoint),
      cells_(config, geometry().nx, geometry().ny),
      sight_(config),
      drift_(config.height_drift) {
    SUREFOOT_ASSERT(!config.problem());
}

void ElevationMap::clear() {
    cells_.clear();
    residuals_.forget();
}

std::int64_t ElevationMap::known_cells() const noexcept {
    const auto& height_m = layers().height_m;
    return std::count_if(height_m.data(), height_m.data() + height_m.size(), [](float h_m) {
        return !std::isnan(h_m);
    });
}

void ElevationMap::follow(const Pose& T_odom_body, const Matrix6& relative_covariance) {
    const MotionNoise noise(relative_covariance, T_odom_body.R());
    if (!T_odom_body.all_finite() || !noise.is_bounded()) {
        clear();
        return;
    }
    cells_.shift(window_.center_on(T_odom_body.translation_m.x(), T_odom_body.translation_m.y()));
    if (!noise.is_zero()) inflate(noise, T_odom_body.translation_m);
}

void ElevationMap::inflate(const MotionNoise& noise, const Eigen::Vector3d& body_m) {
    cells_.count_motion();
    for (int iy = 0; iy < geometry().ny; ++iy) {
        const Eigen::Vector2d first_m = geometry().center_m({0, iy}) - body_m.head<2>();
        const ElevationCells::Memory row = cells_.memory_of_row(iy);
        noise.blur_row({first_m.x(), first_m.y(), geometry().resolution_m, body_m.z()},
                       geometry().nx,
                       row.height_m,
                       row.height_var_m2,
                       row.horizontal_drift_m);
    }
}

FusionCounts ElevationMap::add(const camera::RectifiedRig& rig,
                               const Pose& T_odom_body,
                               const DepthImage& depth,
                               std::int64_t time_ns,
                               Executor& executor) {
    const DepthView view{rig, depth};
    return add(std::span(&view, 1), T_odom_body, time_ns, executor);
}

FusionCounts ElevationMap::add(std::span<const DepthView> views,
                               const Pose& T_odom_body,
                               std::int64_t time_ns,
                               Executor& executor) {
    FusionCounts counts;
    SUREFOOT_ASSERT(!views.empty() && views.size() <= kMostViews);
    if (!T_odom_body.all_finite()) return counts;
    view_count_ = views.size();
    for (std::size_t i = 0; i < views.size(); ++i) {
        const auto& [rig, depth] = views[i];
        SUREFOOT_ASSERT(has_equal_sizes(depth));
        Samples& samples = samples_[i];
        if (DepthSampler::can(config_)) {
            samples.sampler.sample(
                config_, rig, T_odom_body, depth, geometry(), executor, samples.of_image, counts);
        } else {
            points_from_depth(
                config_, rig, T_odom_body, depth, geometry().origin_m, points_, counts);
            sample_points(samples, counts);
        }
        samples.expected.emplace(rig, T_odom_body, geometry());
        const double ratio = rig.fx_px / views.back().rig.fx_px;
        samples.pixel_ratio = static_cast<float>(ratio * ratio);
        // A larger image has more pixels of the same face.
        samples.reduction = config_.reduction;
        samples.reduction.min_face_points =
            saturated_integer<int>(std::round(ratio * ratio * config_.reduction.min_face_points));
    }
    const camera::RectifiedRig& rig = views.back().rig;
    const Eigen::Vector3d camera_m = (T_odom_body * rig.T_body_camera).translation_m;
    fuse_samples(T_odom_body, camera_m, time_ns, executor, counts);
    counts.cells_cleared += sight_.apply(time_ns, executor, cells_);
    return counts;
}

FusionCounts ElevationMap::add_points(std::span<const MeasuredPoint> points,
                                      const Pose& T_body_sensor,
                                      const Pose& T_odom_body,
                                      std::int64_t time_ns,
                                      Executor& executor) {
    FusionCounts counts;
    if (!T_odom_body.all_finite() || !T_body_sensor.all_finite()) return counts;
    points_from_cloud(
        config_, points, T_body_sensor, T_odom_body, geometry().origin_m, points_, counts);
    view_count_ = 1;
    Samples& samples = samples_[0];
    sample_points(samples, counts);
    samples.expected.reset();
    samples.reduction = config_.reduction;
    const Eigen::Vector3d sensor_m = (T_odom_body * T_body_sensor).translation_m;
    fuse_samples(T_odom_body, sensor_m, time_ns, executor, counts);
    counts.cells_cleared += sight_.apply(time_ns, executor, cells_);
    return counts;
}

Result<std::int64_t> ElevationMap::insert(const grid::MapRegion& region,
                                          const Pose& T_odom_body,
                                          const Matrix6& placement_covariance) {
    if (const auto problem = region.problem()) {
        return input_error("no cell of the remembered map is used: " + *problem);
    }
    if (region.resolution_m != geometry().resolution_m) {
        return input_error(
            fmt::format("a remembered map of {} m cells cannot fill cells of {} m: set "
                        "elevation.resolution_m to the cell size of the remembered map",
                        region.resolution_m,
                        geometry().resolution_m));
    }
    grid::MapRegion placed = grid::cut(region, grid::box_of(geometry()));
    const double cell_var_m2 = geometry().resolution_m * geometry().resolution_m / 12.0;
    const Eigen::Vector3d least_m2(cell_var_m2, cell_var_m2, config_.fusion.min_height_var_m2);
    const Eigen::Matrix3d R_body_odom = T_odom_body.R().transpose();
    Matrix6 covariance = placement_covariance;
    covariance.topLeftCorner<3, 3>() +=
        R_body_odom * least_m2.asDiagonal() * R_body_odom.transpose();
    if (Status paid = pay_for_motion(placed, T_odom_body, covariance); !paid) return paid.error();
    std::int64_t filled = 0;
    for (std::size_t cell = 0; cell < placed.height_m.size(); ++cell) {
        if (std::isnan(placed.height_m.data()[cell])) continue;
        if (!std::isnan(layers().height_m.data()[cell])) continue;
        cells_.recall(cell, placed, cell);
        ++filled;
    }
    return filled;
}

void ElevationMap::sample_points(Samples& samples, FusionCounts& counts) {
    const PrefilterConfig& cut = config_.prefilter;
    std::span<GridPoint> points = points_;
    if (cut.down_sampling) points = points.first(filter_.down_sample(cut.sampling_m, points));
    if (cut.outlier_removal) {
        const std::size_t kept =
            filter_.remove_outliers(cut.outlier_radius_m, cut.outlier_min_neighbours, points);
        counts.gated_density += static_cast<std::int64_t>(points.size() - kept);
        points = points.first(kept);
    }
    counts.outside += samples_from_points(points, geometry(), samples.of_image);
}

void ElevationMap::fuse_samples(const Pose& T_odom_body,
                                const Eigen::Vector3d& camera_m,
                                std::int64_t time_ns,
                                Executor& executor,
                                FusionCounts& counts) {
    const RowBlocks rows(geometry());
    const auto nx = static_cast<std::size_t>(geometry().nx);
    for (std::size_t i = 0; i < view_count_; ++i) {
        samples_[i].groups.assign(samples_[i].of_image, layers().height_m.size());
        if (view_count_ > 1)
            samples_[i].measured.resize(static_cast<std::size_t>(rows.count()) * nx);
    }
    sight_.reset(geometry(), camera_m);
    lowest_z_m_ = lowest_z_m(config_.prefilter, T_odom_body);
    const bool aligns = config_.height_drift.enabled;
    measured_.resize(static_cast<std::size_t>(aligns ? geometry().ny : rows.count()) * nx);
    view_.assign(measured_.size(), 0);
    block_counts_.assign(static_cast<std::size_t>(rows.count()), {});
    if (aligns) align_heights(T_odom_body, camera_m, executor);
    struct Job {
        ElevationMap& map;
        FrameObservation look;
    } job{*this, {views_, views_.look_from(T_odom_body), time_ns}};
    // The closure holds one reference only, so std::function allocates no memory.
    executor.parallel_for(rows.count(), [&job](int block) { job.map.fuse_block(block, job.look); });
    for (const FusionCounts& block : block_counts_) counts += block;
}

void ElevationMap::align_heights(const Pose& T_odom_body,
                                 const Eigen::Vector3d& camera_m,
                                 Executor& executor) {
    executor.parallel_for(static_cast<int>(block_counts_.size()),
                          [this](int block) { reduce_block(block); });
    const CellAlignment alignment = cells_.alignment();
    drift_.reserve(geometry());
    height_drift_ = {};
    height_drift_.reason = HeightDriftReason::no_old_ground;
    const std::size_t more =
        residuals_.gather({geometry(),
                           layers(),
                           alignment,
                           measured_.data(),
                           camera_m.head<2>(),
                           ahead_of(T_odom_body),
                           cells_.motions(),
                           static_cast<std::uint32_t>(config_.height_drift.min_motions),
                           static_cast<std::uint32_t>(config_.height_drift.kept_motions),
                           config_.height_drift.level_m,
                           config_.height_drift.min_drift_m});
    if (more == 0) return;
    const auto [report, last_step] = drift_.judge(residuals_.old(),
                                                  residuals_.recent(),
                                                  {geometry(),
                                                   camera_m.z(),
                                                   config_.reduction.systematic_sigma_m,
                                                   config_.camera_tilt_sigma_rad,
                                                   cells_.motions()});
    height_drift_ = report;
    if (report.reason != HeightDriftReason::moved) return;
    residuals_.forget();
    for (std::size_t cell = 0; cell < layers().height_m.size(); ++cell) {
        if (std::isnan(layers().height_m.data()[cell]) || alignment.step[cell] > last_step)
            continue;
        const float motion_m2 =
            motion_variance(layers().height_var_m2.data()[cell], alignment.var_m2[cell]);
        // `allows` returns false for values that are not finite.
        if (!drift_.allows(report.offset_m, static_cast<double>(motion_m2))) continue;
        cells_.lift(cell, report.offset_m, report.sigma_m * report.sigma_m);
        ++height_drift_.moved_cells;
    }
}

void ElevationMap::reduce_block(int block) {
    const RowBlocks rows(geometry());
    for (int iy = rows.first(block); iy < rows.last(block); ++iy) reduce_row(iy);
}

std::ptrdiff_t ElevationMap::row_start(int iy) const {
    const int row = config_.height_drift.enabled ? iy : RowBlocks::of_row(iy);
    return static_cast<std::ptrdiff_t>(row) * geometry().nx;
}

void ElevationMap::reduce_row(int iy) {
    const int nx = geometry().nx;
    CellMeasurement* const measured = measured_.data() + row_start(iy);
    const std::ptrdiff_t scratch = static_cast<std::ptrdiff_t>(RowBlocks::of_row(iy)) * nx;
    for (std::size_t i = 0; i < view_count_; ++i) {
        const CellGroups& groups = samples_[i].groups;
        reduce_cells(samples_[i].reduction,
                     groups.begin() + static_cast<std::ptrdiff_t>(iy) * nx,
                     nx,
                     groups.z_m(),
                     groups.var_m2(),
                     view_count_ > 1 ? samples_[i].measured.data() + scratch : measured);
    }
    if (view_count_ == 1) return;
    std::uint8_t* const view = view_.data() + row_start(iy);
    const CellMeasurement* const finer = samples_[0].measured.data() + scratch;
    const CellMeasurement* const coarser = samples_[1].measured.data() + scratch;
    for (int ix = 0; ix < nx; ++ix) {
        const bool better = is_better(samples_[0], finer[ix], samples_[1], coarser[ix], ix, iy);
        view[ix] = better ? 0 : 1;
        measured[ix] = better ? finer[ix] : coarser[ix];
    }
}

bool ElevationMap::is_better(const Samples& fine,
                             const CellMeasurement& finer,
                             const Samples& coarse,
                             const CellMeasurement& coarser,
                             int ix,
                             int iy) const {
    // A larger image has more pixels of the same surface in a cell.
    const float enough = fine.pixel_ratio * static_cast<float>(config_.reduction.min_points);
    if (!says_something(finer) || static_cast<float>(points_of(fine, ix, iy)) < enough)
        return false;
    if (!says_something(coarser)) return !reaches_out(fine, ix, iy, finer);
    // Above the part that is matched finely, only the coarser view shows an object.
    if (!fine.expected->is_whole_in_view(ix, iy, std::max(finer.z_m, coarser.highest_m)))
        return false;
    const auto sigmas = static_cast<float>(config_.fusion.gate_sigma);
    if (coarser.z_m - finer.z_m > sigmas * std::sqrt(coarser.var_m2 + finer.var_m2)) return false;
    // NaN, the density of surfaces above the camera, is not enough.
    return density_ratio(fine, ix, iy, finer.z_m) >=
           kLeastShareOfCoarser * density_ratio(coarse, ix, iy, coarser.z_m);
}

float ElevationMap::density_ratio(const Samples& samples, int ix, int iy, float z_m) const {
    const float level = samples.expected ? samples.expected->at(ix, iy, z_m) : 0.0F;
    return level > 0.0F ? static_cast<float>(points_of(samples, ix, iy)) / level : kNanF;
}

bool ElevationMap::reaches_out(const Samples& samples,
                               int ix,
                               int iy,
                               const CellMeasurement& measured) const {
    if (!samples.expected) return false;
    return static_cast<float>(points_of(samples, ix, iy)) <
               static_cast<float>(config_.reduction.border_share) *
                   samples.expected->at(ix, iy, measured.z_m) &&
           !samples.expected->is_whole_in_view(ix, iy, measured.z_m);
}

std::uint32_t ElevationMap::points_of(const Samples& samples, int ix, int iy) const {
    const std::uint32_t* begin = samples.groups.begin() +
                                 static_cast<std::ptrdiff_t>(iy) * geometry().nx +
                                 static_cast<std::ptrdiff_t>(ix);
    return begin[1] - begin[0];
}

void ElevationMap::fuse_block(int block, const FrameObservation& look) {
    const int nx = geometry().nx;
    const RowBlocks rows(geometry());
    FusionCounts& counts = block_counts_[static_cast<std::size_t>(block)];
    for (int iy = rows.first(block); iy < rows.last(block); ++iy) {
        if (!config_.height_drift.enabled) reduce_row(iy);
        const CellMeasurement* measured = measured_.data() + row_start(iy);
        const std::uint8_t* view = view_.data() + row_start(iy);
        for (int ix = 0; ix < nx; ++ix) {
            if (!says_something(measured[ix])) continue;
            const auto cell = static_cast<std::size_t>(iy) * static_cast<std::size_t>(nx) +
                              static_cast<std::size_t>(ix);
            const Samples& samples = samples_[view[ix]];
            if (measured[ix].z_m < lowest_z_m_) {
                counts.gated_height += points_of(samples, ix, iy);
                const float not_above_m = sight_.not_above_m(measured[ix].z_m, measured[ix].var_m2);
                if (std::isnan(layers().height_m.data()[cell]))
                    cells_.see_over(cell, std::max(lowest_z_m_, not_above_m));
                continue;
            }
            if (reaches_out(samples, ix, iy, measured[ix])) {
                counts.gated_border += points_of(samples, ix, iy);
                continue;
            }
            const bool is_fine = view[ix] + std::size_t{1} < view_count_;
            CellObservation seen{measured[ix], kNanF, measured[ix].z_m, is_fine};
            seen.density_ratio = density_ratio(samples, ix, iy, measured[ix].z_m);
            const float lowest_m = measured[ix].lowest_m;
            if (samples.expected && static_cast<float>(points_of(samples, ix, iy)) >
                                        kFaceDensity * samples.expected->at(ix, iy, lowest_m))
                seen.bottom_m = std::min(lowest_m, measured[ix].z_m);
            sight_.ended(cell, measured[ix].z_m, measured[ix].var_m2, seen.bottom_m);
            cells_.update(cell, seen, look, counts);
        }
    }
}

}  // namespace surefoot::elevation
