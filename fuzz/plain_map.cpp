// SPDX-License-Identifier: Apache-2.0
#include "fuzz/plain_map.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/elevation/region/region_transfer.hpp"
#include "surefoot/elevation/sampling/depth_points.hpp"

namespace surefoot::fuzz {
namespace {

using namespace surefoot::elevation;

// Confidence in surfaces above a cell and weights of an observation, as in elevation_cells.cpp.
constexpr float kFaceDensity = 3.0F;
constexpr int kSeenAbove = 2;
constexpr int kSureAbove = 4;
constexpr int kMostAbove = 8;
constexpr float kNewObservation = 0.25F;
constexpr float kFirstObservation = 0.5F;
constexpr int kGone = 16;
constexpr int kBeside = 2;

std::int64_t nearest(double way_m, double resolution_m) {
    constexpr double kFarthest = 1 << 30;
    return static_cast<std::int64_t>(
        std::clamp(std::round(way_m / resolution_m), -kFarthest, kFarthest));
}

}  // namespace

PlainMap::PlainMap(const ElevationConfig& config) : config_(config), views_(config.viewpoint) {
    geometry_.resolution_m = config.resolution_m;
    geometry_.nx =
        std::max(1, static_cast<int>(std::lround(config.length_m / config.resolution_m)));
    geometry_.ny = geometry_.nx;
    first_ix_ = first_iy_ = -(geometry_.nx / 2);
    geometry_.origin_m = config.resolution_m * Eigen::Vector2d(first_ix_, first_iy_);
}

void PlainMap::follow(const Pose& T_odom_body, const Matrix6& relative_covariance) {
    const MotionNoise noise(relative_covariance, T_odom_body.R());
    if (!T_odom_body.all_finite() || !noise.is_bounded()) return clear();
    const double half_m = 0.5 * geometry_.nx * geometry_.resolution_m;
    const Eigen::Vector2d way_m = T_odom_body.translation_m.head<2>() -
                                  (geometry_.origin_m + Eigen::Vector2d(half_m, half_m));
    first_ix_ += nearest(way_m.x(), geometry_.resolution_m);
    first_iy_ += nearest(way_m.y(), geometry_.resolution_m);
    geometry_.origin_m = {static_cast<double>(first_ix_) * geometry_.resolution_m,
                          static_cast<double>(first_iy_) * geometry_.resolution_m};
    std::erase_if(cells_, [&](const auto& entry) {
        const auto [iy, ix] = entry.first;
        return ix < first_ix_ || iy < first_iy_ || ix >= first_ix_ + geometry_.nx ||
               iy >= first_iy_ + geometry_.ny;
    });
    if (noise.is_zero()) return;
    for (int iy = 0; iy < geometry_.ny; ++iy) {
        std::vector<float> height_m, var_m2, drift_m;
        for (int ix = 0; ix < geometry_.nx; ++ix) {
            const Known cell = known(ix, iy);
            height_m.push_back(cell.height_m);
            var_m2.push_back(cell.height_var_m2);
            drift_m.push_back(cell.horizontal_drift_m);
        }
        const Eigen::Vector2d first_m =
            geometry_.center_m({0, iy}) - T_odom_body.translation_m.head<2>();
        noise.blur_row(
            {first_m.x(), first_m.y(), geometry_.resolution_m, T_odom_body.translation_m.z()},
            geometry_.nx,
            height_m.data(),
            var_m2.data(),
            drift_m.data());
        for (int ix = 0; ix < geometry_.nx; ++ix) {
            const auto cell = cells_.find(lattice_of(ix, iy));
            if (cell == cells_.end()) continue;
            cell->second.height_var_m2 = var_m2[static_cast<std::size_t>(ix)];
            cell->second.horizontal_drift_m = drift_m[static_cast<std::size_t>(ix)];
        }
    }
}

FusionCounts PlainMap::add(const camera::RectifiedRig& rig,
                           const Pose& T_odom_body,
                           const DepthImage& depth,
                           std::int64_t time_ns) {
    FusionCounts counts;
    if (!T_odom_body.all_finite()) return counts;
    Samples samples;
    if (DepthSampler::can(config_)) {
        // Both maps use the sampler, because its heights are rounded to floats. This test compares
        // the steps after it.
        CellSamples found;
        DepthSampler().sample(config_, rig, T_odom_body, depth, geometry_, serial(), found, counts);
        for (int block = 0; block < found.blocks(); ++block) {
            const CellSamples::Block of = found.block(block);
            for (std::size_t i = 0; i < of.cell.size(); ++i) {
                const auto nx = static_cast<std::uint32_t>(geometry_.nx);
                Heights& heights = samples[lattice_of(static_cast<int>(of.cell[i] % nx),
                                                      static_cast<int>(of.cell[i] / nx))];
                heights.z_m.push_back(of.z_m[i]);
                heights.var_m2.push_back(of.var_m2[i]);
            }
        }
    } else {
        std::vector<GridPoint> points;
        points_from_depth(config_, rig, T_odom_body, depth, geometry_.origin_m, points, counts);
        samples = samples_of(points, counts);
    }
    const ExpectedPoints expected(rig, T_odom_body, geometry_);
    fuse(samples,
         T_odom_body,
         (T_odom_body * rig.T_body_camera).translation_m,
         &expected,
         time_ns,
         counts);
    return counts;
}

FusionCounts PlainMap::add_points(std::span<const MeasuredPoint> cloud,
                                  const Pose& T_body_sensor,
                                  const Pose& T_odom_body,
                                  std::int64_t time_ns) {
    FusionCounts counts;
    if (!T_odom_body.all_finite() || !T_body_sensor.all_finite()) return counts;
    std::vector<GridPoint> points;
    points_from_cloud(
        config_, cloud, T_body_sensor, T_odom_body, geometry_.origin_m, points, counts);
    fuse(samples_of(points, counts),
         T_odom_body,
         (T_odom_body * T_body_sensor).translation_m,
         nullptr,
         time_ns,
         counts);
    return counts;
}

PlainMap::Samples PlainMap::samples_of(std::vector<GridPoint>& points, FusionCounts& counts) const {
    const PrefilterConfig& cut = config_.prefilter;
    CloudFilter filter;
    std::span<GridPoint> left = points;
    if (cut.down_sampling) left = left.first(filter.down_sample(cut.sampling_m, left));
    if (cut.outlier_removal) {
        const std::size_t before = left.size();
        left = left.first(
            filter.remove_outliers(cut.outlier_radius_m, cut.outlier_min_neighbours, left));
        counts.gated_density += static_cast<std::int64_t>(before - left.size());
    }
    return samples_of(std::span<const GridPoint>(left), counts);
}

PlainMap::Samples PlainMap::samples_of(std::span<const GridPoint> points,
                                       FusionCounts& counts) const {
    Samples samples;
    const auto per_m = static_cast<float>(1.0 / geometry_.resolution_m);
    for (const GridPoint& point : points) {
        const double ix = std::floor(static_cast<double>(point.x_m * per_m));
        const double iy = std::floor(static_cast<double>(point.y_m * per_m));
        const bool inside = ix >= 0.0 && iy >= 0.0 && ix < geometry_.nx && iy < geometry_.ny;
        if (!inside || !std::isfinite(point.z_m) || !std::isfinite(point.var_m2)) {
            ++counts.outside;
            continue;
        }
        Heights& heights = samples[lattice_of(static_cast<int>(ix), static_cast<int>(iy))];
        heights.z_m.push_back(point.z_m);
        heights.var_m2.push_back(point.var_m2);
    }
    return samples;
}

void PlainMap::fuse(const Samples& samples,
                    const Pose& T_odom_body,
                    const Eigen::Vector3d& camera_m,
                    const ExpectedPoints* expected,
                    std::int64_t time_ns,
                    FusionCounts& counts) {
    view_ = views_.look_from(T_odom_body);
    RayEndpoints ends;
    ends.reset(geometry_, camera_m);
    std::vector<std::pair<grid::Cell, float>> agreed;  // cells that an earlier observation confirms
    for (const auto& [index, heights] : samples) {
        const auto measured = reduce_cell(config_.reduction, heights.z_m, heights.var_m2);
        if (!measured || !std::isfinite(measured->z_m) || !std::isfinite(measured->var_m2)) {
            continue;
        }
        if (measured->z_m < lowest_z_m(config_.prefilter, T_odom_body)) {
            counts.gated_height += static_cast<std::int64_t>(heights.z_m.size());
            Cell& cell = cells_[index];
            const float below_m = lowest_z_m(config_.prefilter, T_odom_body);
            if (std::isnan(cell.height_m))
                see_over(cell, std::max(below_m, not_above_m(*measured)));
            continue;
        }
        const auto ix = static_cast<int>(index.second - first_ix_);
        const auto iy = static_cast<int>(index.first - first_iy_);
        CellObservation seen{*measured, kNan, measured->z_m};
        if (expected != nullptr) {
            const auto points = static_cast<float>(heights.z_m.size());
            const float level = expected->at(ix, iy, measured->z_m);
            if (points < static_cast<float>(config_.reduction.border_share) * level &&
                !expected->is_whole_in_view(ix, iy, measured->z_m)) {
                counts.gated_border += static_cast<std::int64_t>(heights.z_m.size());
                continue;
            }
            if (level > 0.0F) seen.density_ratio = points / level;
            if (points > kFaceDensity * expected->at(ix, iy, measured->lowest_m))
                seen.bottom_m = std::min(measured->lowest_m, measured->z_m);
        }
        ends.set(static_cast<std::size_t>(iy * geometry_.nx + ix), measured->z_m, seen.bottom_m);
        Cell& cell = cells_[index];
        update(cell, seen, time_ns, counts);
        const bool is_agreed = cell.seen_ns == time_ns && cell.count > 1;
        if (is_agreed) agreed.emplace_back(grid::Cell{ix, iy}, not_above_m(*measured));
    }
    look_overhead(ends);
    FreeSpaceRays lines;
    lines.reset(geometry_, camera_m);
    for (const auto& [at, z_m] : agreed) lines.add(at, z_m);
    lines.finish();
    if (config_.visibility.drops) look_over_unknown(lines);
    if (!config_.visibility.cleanup) return;
    const std::vector<Index> gone = find_gone(ends, lines, time_ns);
    for (const Index& index : gone) forget(cells_.at(index));
    counts.cells_cleared += static_cast<std::int64_t>(gone.size());
}

void PlainMap::look_over_unknown(const FreeSpaceRays& lines) {
    for (int iy = 0; iy < geometry_.ny; ++iy) {
        for (int ix = 0; ix < geometry_.nx; ++ix) {
            const float line_z_m = lines.lowest_over({ix, iy});
            if (!(line_z_m < std::numeric_limits<float>::infinity())) continue;
            Cell& cell = cells_[lattice_of(ix, iy)];
            if (std::isnan(cell.height_m)) see_over(cell, line_z_m);
        }
    }
}

void PlainMap::see_over(Cell& cell, float line_z_m) {
    if (!(cell.bottom_m <= line_z_m)) {
        cell.free_above_m = cell.bottom_m;
        cell.bottom_m = line_z_m;
    } else if (!(cell.free_above_m <= line_z_m)) {
        cell.free_above_m = line_z_m;
    }
}

std::vector<PlainMap::Index> PlainMap::find_gone(const RayEndpoints& ends,
                                                 const FreeSpaceRays& lines,
                                                 std::int64_t time_ns) {
    const VisibilityConfig& visibility = config_.visibility;
    const auto margin_m = static_cast<float>(visibility.margin_m);
    std::vector<Index> gone;
    for (auto& [index, cell] : cells_) {
        if (std::isnan(cell.height_m) || cell.seen_ns == time_ns) continue;
        const grid::Cell at{static_cast<int>(index.second - first_ix_),
                            static_cast<int>(index.first - first_iy_)};
        const float seen_m = ends.z_m(static_cast<std::size_t>(at.iy * geometry_.nx + at.ix));
        const float line_m = lines.lowest_over(at);
        const float lowest_m = seen_m < line_m ? seen_m : line_m;
        const float sigma_m = std::sqrt(cell.height_var_m2);
        const bool above =
            cell.height_m - lowest_m > margin_m + static_cast<float>(visibility.sigmas) * sigma_m;
        if (!above) continue;
        const bool stands =
            cell.bottom_m - lowest_m <= static_cast<float>(config_.min_overhead_m) ||
            cell.count == 1;
        if (!stands && !ends.passed_through(at, cell.height_m - margin_m, cell.height_m + margin_m))
            continue;
        const int enough = visibility.frames * kGone;
        cell.seen_through = std::min(cell.seen_through + cell.steady, enough);
        if (cell.seen_through == enough && !stands_beside(index, time_ns)) gone.push_back(index);
    }
    return gone;
}

bool PlainMap::stands_beside(Index index, std::int64_t time_ns) const {
    const std::int64_t since_ns = time_ns - ns_from_seconds(config_.visibility.neighbour_s);
    const float height_m = cells_.at(index).height_m;
    for (std::int64_t iy = index.first - kBeside; iy <= index.first + kBeside; ++iy) {
        for (std::int64_t ix = index.second - kBeside; ix <= index.second + kBeside; ++ix) {
            const auto found = cells_.find({iy, ix});
            if (found == cells_.end() || found->second.seen_ns < since_ns) continue;
            const float apart_m = std::abs(found->second.height_m - height_m);
            if (apart_m < static_cast<float>(config_.visibility.margin_m)) return true;
        }
    }
    return false;
}

void PlainMap::forget(Cell& cell) {
    const float before_m = cell.bottom_m;
    const int trust = cell.count > 1 ? kMostAbove : kSeenAbove;
    cell = {};
    see_above(cell, before_m, trust, true);
}

void PlainMap::set_confidence(Cell& cell, float confidence) {
    cell.confidence = confidence;
    cell.steady = static_cast<int>(std::lround(kGone * confidence));
}

void PlainMap::look_overhead(const RayEndpoints& ends) {
    const auto margin_m = static_cast<float>(config_.visibility.margin_m);
    for (int iy = 0; iy < geometry_.ny; ++iy) {
        for (int ix = 0; ix < geometry_.nx; ++ix) {
            const auto found = cells_.find(lattice_of(ix, iy));
            if (found == cells_.end() || std::isnan(found->second.overhead_m)) continue;
            const float z_m = found->second.overhead_m;
            if (ends.passed_through({ix, iy}, z_m - margin_m, z_m + margin_m))
                see_no_more_above(found->second);
        }
    }
}

void PlainMap::update(Cell& cell,
                      const CellObservation& seen,
                      std::int64_t time_ns,
                      FusionCounts& counts) {
    const CellMeasurement& measured = seen.measured;
    ++counts.cells_measured;
    if (std::isnan(cell.height_m) || !std::isfinite(cell.height_var_m2)) {
        ++counts.cells_new;
        start(cell, seen, time_ns);
        return;
    }
    const double scan_s = config_.fusion.scan_duration_s;
    const bool same_scan = scan_s > 0.0 && time_ns - cell.seen_ns <= ns_from_seconds(scan_s);
    const float before_m = cell.height_m;
    const float bottom_m = cell.bottom_m;
    const int trust = cell.count > 1 ? kMostAbove : kSeenAbove;
    const FusionResult result =
        elevation::fuse(config_.fusion,
                        {static_cast<double>(before_m), static_cast<double>(cell.height_var_m2)},
                        {static_cast<double>(measured.z_m), static_cast<double>(measured.var_m2)},
                        same_scan);
    if (result.outcome == FusionOutcome::fused) {
        ++counts.cells_fused;
        agree(cell, result.cell, seen, time_ns);
        return;
    }
    ++counts.cells_inflated;
    cell.confidence *= 1.0F - kNewObservation;
    const auto hangs = static_cast<float>(config_.min_overhead_m);
    if (result.outcome == FusionOutcome::replaced) {
        start(cell, seen, time_ns);
        if (bottom_m - measured.z_m > hangs) see_above(cell, bottom_m, trust, true);
    } else if (result.outcome == FusionOutcome::inflated) {
        cell.height_var_m2 = static_cast<float>(result.cell.var_m2);
        if (measured.z_m - before_m > hangs)
            see_above(cell, measured.z_m, kSeenAbove, seen.bottom_m - before_m > hangs);
    }
}

void PlainMap::start(Cell& cell, const CellObservation& seen, std::int64_t time_ns) {
    const CellMeasurement& measured = seen.measured;
    cell.height_m = measured.z_m;
    cell.height_var_m2 =
        std::max(measured.var_m2, static_cast<float>(config_.fusion.min_height_var_m2));
    cell.count = 1;
    cell.seen_ns = time_ns;
    cell.horizontal_drift_m = 0.0F;
    cell.highest_m = measured.highest_m;
    cell.lowest_m = measured.lowest_m;
    set_confidence(cell, kFirstObservation);
    cell.density_ratio = seen.density_ratio;
    cell.free_above_m = kNan;
    cell.seen_through = 0;
    cell.settled_var_m2 = cell.height_var_m2;
    cell.view = view_;
    cell.bottom_m = seen.bottom_m;
    drop_what_touches(cell);
    set_clearance(cell);
}

void PlainMap::agree(Cell& cell,
                     const Height& fused,
                     const CellObservation& seen,
                     std::int64_t time_ns) {
    const CellMeasurement& measured = seen.measured;
    if (views_.is_new_since(cell.view)) {
        cell.height_m = static_cast<float>(fused.z_m);
        cell.height_var_m2 = cell.settled_var_m2 = static_cast<float>(fused.var_m2);
        cell.view = view_;
    } else if (const float sure_m2 = std::max(measured.var_m2, cell.settled_var_m2);
               cell.height_var_m2 > sure_m2) {
        cell.height_m = measured.z_m;
        cell.height_var_m2 = cell.settled_var_m2 = sure_m2;
        cell.view = view_;
    }
    ++cell.count;
    cell.seen_ns = time_ns;
    cell.horizontal_drift_m = 0.0F;
    cell.highest_m = std::max(cell.highest_m, measured.highest_m);
    cell.lowest_m = std::min(cell.lowest_m, measured.lowest_m);
    set_confidence(cell, cell.confidence + kNewObservation * (1.0F - cell.confidence));
    cell.seen_through = 0;
    if (std::isnan(cell.density_ratio)) {
        cell.density_ratio = seen.density_ratio;
    } else if (!std::isnan(seen.density_ratio)) {
        cell.density_ratio += kNewObservation * (seen.density_ratio - cell.density_ratio);
    }
    cell.bottom_m = std::min(cell.bottom_m, seen.bottom_m);
    if (!cell.overhead_hangs) see_no_more_above(cell);
    set_clearance(cell);
}

void PlainMap::drop_what_touches(Cell& cell) const {
    if (cell.overhead_m - cell.height_m > static_cast<float>(config_.min_overhead_m)) return;
    cell.overhead_m = kNan;
    cell.overhead_trust = 0;
    cell.overhead_hangs = false;
}

void PlainMap::see_no_more_above(Cell& cell) {
    if (cell.overhead_trust == 0) return;
    if (--cell.overhead_trust == 0) {
        cell.overhead_m = kNan;
        cell.overhead_hangs = false;
    }
    set_clearance(cell);
}

void PlainMap::see_above(Cell& cell, float z_m, int trust, bool hangs) {
    cell.overhead_hangs = cell.overhead_hangs || hangs;
    if (!(cell.overhead_m <= z_m)) cell.overhead_m = z_m;
    cell.overhead_trust = std::min(cell.overhead_trust + trust, kMostAbove);
    set_clearance(cell);
}

void PlainMap::set_clearance(Cell& cell) {
    cell.clearance_m = cell.overhead_trust >= kSureAbove ? cell.overhead_m - cell.height_m : kNan;
}

std::int64_t PlainMap::insert(const grid::MapRegion& region,
                              const Pose& T_odom_body,
                              const Matrix6& placement_covariance) {
    grid::MapRegion placed = grid::cut(region, {first_ix_, first_iy_, geometry_.nx, geometry_.ny});
    const double cell_var_m2 = geometry_.resolution_m * geometry_.resolution_m / 12.0;
    const Eigen::Matrix3d R_body_odom = T_odom_body.R().transpose();
    const Eigen::Vector3d least_m2(cell_var_m2, cell_var_m2, config_.fusion.min_height_var_m2);
    Matrix6 covariance = placement_covariance;
    covariance.topLeftCorner<3, 3>() +=
        R_body_odom * least_m2.asDiagonal() * R_body_odom.transpose();
    if (!pay_for_motion(placed, T_odom_body, covariance)) return 0;
    std::int64_t filled = 0;
    for (int iy = 0; iy < geometry_.ny; ++iy) {
        for (int ix = 0; ix < geometry_.nx; ++ix) {
            if (std::isnan(placed.height_m.at(ix, iy))) continue;
            Cell& cell = cells_[lattice_of(ix, iy)];
            if (!std::isnan(cell.height_m)) continue;
            cell.height_m = placed.height_m.at(ix, iy);
            cell.height_var_m2 = std::max(placed.height_var_m2.at(ix, iy),
                                          static_cast<float>(config_.fusion.min_height_var_m2));
            cell.count = placed.count.at(ix, iy);
            cell.seen_ns = 0;
            cell.horizontal_drift_m = placed.horizontal_drift_m.at(ix, iy);
            cell.highest_m = placed.highest_m.at(ix, iy);
            cell.lowest_m = placed.lowest_m.at(ix, iy);
            set_confidence(cell, placed.confidence.at(ix, iy));
            cell.free_above_m = kNan;
            cell.seen_through = 0;
            cell.density_ratio = placed.density_ratio.at(ix, iy);
            cell.settled_var_m2 = cell.height_var_m2;
            cell.view = ViewpointHistory::kNever;
            cell.bottom_m = cell.height_m;
            drop_what_touches(cell);
            const float clearance_m = placed.clearance_m.at(ix, iy);
            if (!std::isnan(clearance_m))
                see_above(cell, cell.height_m + clearance_m, kMostAbove, true);
            set_clearance(cell);
            ++filled;
        }
    }
    return filled;
}

grid::MapRegion PlainMap::layers() const {
    grid::MapRegion region;
    grid::for_each_layer([&](const grid::RegionLayer&, auto member, auto unknown) {
        (region.*member).resize(geometry_.nx, geometry_.ny);
        (region.*member).fill(unknown);
    });
    for (const auto& [index, cell] : cells_) {
        const auto iy = static_cast<int>(index.first - first_iy_);
        const auto ix = static_cast<int>(index.second - first_ix_);
        region.height_m.at(ix, iy) = cell.height_m;
        region.height_var_m2.at(ix, iy) = cell.height_var_m2;
        region.count.at(ix, iy) = cell.count;
        region.seen_ns.at(ix, iy) = cell.seen_ns;
        region.horizontal_drift_m.at(ix, iy) = cell.horizontal_drift_m;
        region.highest_m.at(ix, iy) = cell.highest_m;
        region.lowest_m.at(ix, iy) = cell.lowest_m;
        region.clearance_m.at(ix, iy) = cell.clearance_m;
        region.confidence.at(ix, iy) = cell.confidence;
        region.density_ratio.at(ix, iy) = cell.density_ratio;
    }
    return region;
}

Image<float> PlainMap::free_above_m() const {
    Image<float> all(geometry_.nx, geometry_.ny, kNan);
    for (const auto& [index, cell] : cells_) {
        all.at(static_cast<int>(index.second - first_ix_),
               static_cast<int>(index.first - first_iy_)) = cell.free_above_m;
    }
    return all;
}

PlainMap::Known PlainMap::known(int ix, int iy) const {
    const auto cell = cells_.find(lattice_of(ix, iy));
    return cell == cells_.end() ? Known{} : static_cast<const Known&>(cell->second);
}

}  // namespace surefoot::fuzz
