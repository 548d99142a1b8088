// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/laser_scanner.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Number of columns in memory: enough for the threads of a desktop computer. At the default
/// resolution they need about 17 MB.
constexpr int kBatch = 16;
/// Weights of a mean over a disc, from its centre and four points at sqrt(2/3) of the radius. The
/// mean is exact for polynomials of third degree (Abramowitz and Stegun 25.4.61).
constexpr double kCenterWeight = 0.25;
constexpr double kRingWeight = 0.1875;
constexpr double kRingRadius = 0.816496580927726;
/// Reflectance for which the maximum range holds.
constexpr double kWhite = 0.9;

/// Number of steps in a span; tolerates angles that decimal fractions do not represent exactly.
int steps_in(double span_deg, double step_deg) {
    // in range: LaserScannerConfig::describe() keeps spans up to 720 deg and steps from 0.001 deg
    return static_cast<int>(std::floor(span_deg / step_deg + 1e-6));
}

}  // namespace

void LaserScannerConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "azimuth_min_deg", azimuth_min_deg, -360.0, 360.0, "azimuth of the first column");
    visitor.number("azimuth_max_deg",
                   azimuth_max_deg,
                   -360.0,
                   360.0,
                   "azimuth at which the scan ends; this azimuth itself is excluded");
    visitor.number(
        "elevation_min_deg", elevation_min_deg, -90.0, 90.0, "elevation of the first row");
    visitor.number(
        "elevation_max_deg", elevation_max_deg, -90.0, 90.0, "elevation of the last row");
    visitor.number("step_deg",
                   step_deg,
                   0.001,
                   90.0,
                   "angle between neighbouring columns and between neighbouring rows");
    visitor.number("min_range_m", min_range_m, 0.0, 100.0, "smallest range that is measured");
    visitor.number("max_range_m",
                   max_range_m,
                   0.0,
                   1e4,
                   "largest range that is measured on a surface of 90 % reflectance seen head-on");
    visitor.number(
        "noise_floor_m", noise_floor_m, 0.0, 1.0, "one sigma of the range noise at range 0");
    visitor.number("noise_growth",
                   noise_growth,
                   0.0,
                   0.1,
                   "growth of the range noise per metre of range, on a white surface seen head-on");
    visitor.number("beam_exit_m", beam_exit_m, 0.0, 0.1, "diameter of the beam at the scanner");
    visitor.number("beam_divergence_rad",
                   beam_divergence_rad,
                   0.0,
                   0.1,
                   "growth of the beam diameter per metre of range");
}

Result<LaserScanner> LaserScanner::make(const Scene& scene,
                                        const LaserScannerConfig& config,
                                        std::uint64_t seed) {
    if (!(config.step_deg > 0.0)) {
        return usage_error(
            fmt::format("simulator: laser: step_deg = {} must be positive", config.step_deg));
    }
    const LaserScanner scanner(scene, config, seed);
    if (scanner.columns_ < 1 || scanner.rows_ < 1) {
        return usage_error(
            fmt::format("simulator: laser: azimuth {} to {} deg and elevation {} to {} deg contain "
                        "no beam; the second angle of each must be above the first",
                        config.azimuth_min_deg,
                        config.azimuth_max_deg,
                        config.elevation_min_deg,
                        config.elevation_max_deg));
    }
    if (!(config.min_range_m < config.max_range_m)) {
        return usage_error(
            fmt::format("simulator: laser: min_range_m = {} must be below max_range_m = {}",
                        config.min_range_m,
                        config.max_range_m));
    }
    return scanner;
}

LaserScanner::LaserScanner(const Scene& scene, const LaserScannerConfig& config, std::uint64_t seed)
    : scene_(&scene),
      config_(config),
      seed_(seed),
      columns_(steps_in(config.azimuth_max_deg - config.azimuth_min_deg, config.step_deg)),
      rows_(steps_in(config.elevation_max_deg - config.elevation_min_deg, config.step_deg) + 1) {}

double LaserScanner::sigma_m(double range_m, double return_share) const {
    const double growth_m = config_.noise_growth * range_m;
    return std::sqrt(config_.noise_floor_m * config_.noise_floor_m +
                     growth_m * growth_m / return_share);
}

double LaserScanner::azimuth_rad(int column) const {
    return (config_.azimuth_min_deg + column * config_.step_deg) * kRadPerDeg;
}

void LaserScanner::scan(const Pose& T_world_scanner,
                        int station,
                        Executor& executor,
                        const std::function<bool(const ScanColumn&)>& take) const {
    const auto rows = static_cast<std::size_t>(rows_);
    std::vector<std::vector<ScanPoint>> batch(kBatch, std::vector<ScanPoint>(rows));
    std::vector<Beams> beams(kBatch);
    for (int first = 0; first < columns_; first += kBatch) {
        const int count = std::min(kBatch, columns_ - first);
        executor.parallel_for(count, [&](int i) {
            const auto slot = static_cast<std::size_t>(i);
            scan_column(T_world_scanner, station, first + i, beams[slot], batch[slot]);
        });
        for (int i = 0; i < count; ++i) {
            const int column = first + i;
            if (!take({column, azimuth_rad(column), batch[static_cast<std::size_t>(i)]})) return;
        }
    }
}

/// Casts the middle rays of a column.
void LaserScanner::aim(const Pose& T_world_scanner, int column, Beams& beams) const {
    const auto rows = static_cast<std::size_t>(rows_);
    beams.directions_scanner.resize(rows);
    beams.directions.resize(rows);
    const double azimuth = azimuth_rad(column);
    const Vector3d ahead(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Eigen::Matrix3d R_world_scanner = T_world_scanner.R();
    for (std::size_t row = 0; row < rows; ++row) {
        const double elevation =
            (config_.elevation_min_deg + static_cast<double>(row) * config_.step_deg) * kRadPerDeg;
        beams.directions_scanner[row] =
            std::cos(elevation) * ahead + std::sin(elevation) * Vector3d::UnitZ();
        beams.directions[row] = R_world_scanner * beams.directions_scanner[row];
    }
    beams.hits.assign(rows, RayHit{});
    for (int k = 0; k < scene_->primitives(); ++k) {
        scene_->intersect_primitive(k, T_world_scanner.translation_m, beams.directions, beams.hits);
    }
}

/// Sets the directions of four rays from the station through the disc that the beam lights. The
/// disc lies at the range of the middle ray.
void LaserScanner::widen(Beams& beams) const {
    beams.ring.clear();
    for (std::size_t row = 0; row < beams.directions.size(); ++row) {
        const Vector3d& axis = beams.directions[row];
        const double range_m = std::min(beams.hits[row].distance_m, config_.max_range_m);
        const double radius_m =
            0.5 * kRingRadius * (config_.beam_exit_m + config_.beam_divergence_rad * range_m);
        const Vector3d side = axis.unitOrthogonal();
        const Vector3d up = axis.cross(side);
        const double tangent = radius_m / std::max(range_m, config_.min_range_m);
        for (const Vector3d& way : {side, Vector3d(-side), up, Vector3d(-up)}) {
            beams.ring.push_back((axis + tangent * way).normalized());
        }
    }
}

void LaserScanner::scan_column(const Pose& T_world_scanner,
                               int station,
                               int column,
                               Beams& beams,
                               std::span<ScanPoint> out) const {
    aim(T_world_scanner, column, beams);
    widen(beams);
    beams.ring_hits.assign(beams.ring.size(), RayHit{});
    for (int k = 0; k < scene_->primitives(); ++k) {
        scene_->intersect_primitive(k, T_world_scanner.translation_m, beams.ring, beams.ring_hits);
    }
    const std::uint64_t stream =
        mix_seed(static_cast<std::uint64_t>(station), static_cast<std::uint64_t>(column));
    for (std::size_t row = 0; row < beams.hits.size(); ++row) {
        ScanPoint& point = out[row];
        point = {Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), -1, false};
        double share = 0.0;
        const double true_m = range_m(T_world_scanner, beams, row, point, share);
        if (!(share > 0.0) || true_m < config_.min_range_m) continue;
        if (true_m > config_.max_range_m * std::sqrt(std::min(share / kWhite, 1.0))) continue;
        const float normal =
            noise_.normal(PixelNoise::key(seed_, stream), static_cast<std::uint32_t>(row));
        const double error_m = sigma_m(true_m, share) * static_cast<double>(normal);
        point.point_scanner_m = (true_m + error_m) * beams.directions_scanner[row];
    }
}

/// Share of light that a matt surface returns; 0 for other surfaces.
double LaserScanner::return_share(int surface,
                                  const Vector3d& point_m,
                                  const Vector3d& direction) const {
    const Surface& face = scene_->surfaces()[static_cast<std::size_t>(surface)];
    const Material& material = scene_->materials()[static_cast<std::size_t>(face.material)];
    if (material.finish != Finish::matte) return 0.0;
    const double cosine = -scene_->surface_point(surface, point_m).normal.dot(direction);
    return material.albedo * std::max(cosine, 0.0);
}

/// Range that the beam measures without noise. On one surface only, it is the range of the middle
/// ray.
double LaserScanner::range_m(const Pose& T_world_scanner,
                             const Beams& beams,
                             std::size_t row,
                             ScanPoint& out,
                             double& share) const {
    const RayHit& middle = beams.hits[row];
    out.surface = middle.face;
    double weight_sum = 0.0;
    double weighted_m = 0.0;
    const auto add = [&](const RayHit& hit, const Vector3d& direction, double area) {
        if (hit.face < 0 || hit.distance_m > config_.max_range_m) return;
        const Vector3d point_m = T_world_scanner.translation_m + hit.distance_m * direction;
        const double weight = area * return_share(hit.face, point_m, direction);
        weight_sum += weight;
        weighted_m += weight * hit.distance_m;
    };
    add(middle, beams.directions[row], kCenterWeight);
    share = weight_sum / kCenterWeight;
    const std::size_t first = 4 * row;
    for (std::size_t i = first; i < first + 4; ++i) {
        out.mixed = out.mixed || beams.ring_hits[i].face != middle.face;
    }
    if (!out.mixed) return middle.distance_m;
    for (std::size_t i = first; i < first + 4; ++i) {
        add(beams.ring_hits[i], beams.ring[i], kRingWeight);
    }
    share = weight_sum;
    return weight_sum > 0.0 ? weighted_m / weight_sum : middle.distance_m;
}

}  // namespace surefoot::sim
