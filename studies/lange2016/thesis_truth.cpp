// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "service/console/interrupt.hpp"
#include "studies/clouds/stray_points.hpp"
#include "studies/simulation/scan.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/eval/clouds/voxels.hpp"
#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::app {
namespace {

constexpr double kVoxel_m = 0.001;
constexpr std::size_t kNoCell = std::numeric_limits<std::size_t>::max();
constexpr eval::OutlierConfig kOutliers{.others = 6, .sigmas = 4.0};
/// Height limit above the ground [m], as in the filter of the map. Higher surfaces are above the
/// head.
constexpr double kCeiling_m = 2.0;

bool holds(const ScanArea& area, const Eigen::Vector3d& p_m) {
    return p_m.x() >= area.low_m.x() && p_m.x() <= area.high_m.x() && p_m.y() >= area.low_m.y() &&
           p_m.y() <= area.high_m.y() && p_m.z() <= area.ceiling_m;
}

double distance_m(const ScanArea& area, const Eigen::Vector3d& station_m) {
    const Eigen::Vector2d at_m = station_m.head<2>();
    return (at_m - at_m.cwiseMax(area.low_m).cwiseMin(area.high_m)).norm();
}

/// Returns the stations that are near enough to the area, or the nearest station if there are none.
std::vector<std::size_t> near_stations(const std::vector<Eigen::Vector3d>& all_m,
                                       const ScanArea& area) {
    std::vector<std::size_t> near;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < all_m.size(); ++i) {
        if (distance_m(area, all_m[i]) <= area.farthest_m) near.push_back(i);
        if (distance_m(area, all_m[i]) < distance_m(area, all_m[nearest])) nearest = i;
    }
    if (near.empty()) near.push_back(nearest);
    return near;
}

/// Returns the cells of the area, on the lattice that all maps of this resolution share.
grid::GridGeometry cells_of(const ScanArea& area, double resolution_m) {
    const Eigen::Vector2d first = (area.low_m / resolution_m).array().floor();
    const Eigen::Vector2d end = (area.high_m / resolution_m).array().ceil();
    grid::GridGeometry geometry;
    geometry.resolution_m = resolution_m;
    geometry.nx = grid::whole_cells(end.x() - first.x());
    geometry.ny = grid::whole_cells(end.y() - first.y());
    geometry.origin_m = resolution_m * first;
    return geometry;
}

std::vector<Eigen::Vector3f> without_outliers(std::vector<Eigen::Vector3f> points_m,
                                              Executor& executor) {
    const eval::OutlierFilter filter(geometry::KdTree(points_m, executor), kOutliers, executor);
    std::erase_if(points_m, [&](const Eigen::Vector3f& p_m) { return !filter.keeps(p_m); });
    return points_m;
}

/// Returns the highest supported surface of a cell: the highest point with enough other points
/// closely below it. Far from a station a cell may have fewer than three points; then all must
/// agree. NaN if no points agree. Sorts `z_m`.
float supported_height_m(std::span<float> z_m) {
    constexpr float kClose_m = 0.02F;
    constexpr std::size_t kFewest = 3;
    constexpr std::size_t kShare = 50;  // the surface needs at least one in 50 points of the cell
    if (z_m.empty()) return std::nanf("");
    std::sort(z_m.begin(), z_m.end(), std::greater<>());
    const std::size_t enough = std::min(std::max(kFewest, z_m.size() / kShare), z_m.size());
    for (std::size_t i = 0; i + enough <= z_m.size(); ++i) {
        if (z_m[i] - z_m[i + enough - 1] <= kClose_m) return z_m[i];
    }
    return std::nanf("");
}

grid::Layer heights_of(const std::vector<Eigen::Vector3f>& points_m,
                       const grid::GridGeometry& geometry) {
    const auto cell_of = [&](const Eigen::Vector3f& p_m) -> std::size_t {
        const auto cell =
            geometry.cell_at(static_cast<double>(p_m.x()), static_cast<double>(p_m.y()));
        return cell ? static_cast<std::size_t>(cell->iy) * static_cast<std::size_t>(geometry.nx) +
                          static_cast<std::size_t>(cell->ix)
                    : kNoCell;
    };
    grid::Layer height_m(geometry.nx, geometry.ny, std::nanf(""));
    std::vector<std::size_t> first(height_m.size() + 1, 0);
    for (const Eigen::Vector3f& p_m : points_m) {
        const std::size_t cell = cell_of(p_m);
        if (cell != kNoCell) ++first[cell + 1];
    }
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<float> z_m(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (const Eigen::Vector3f& p_m : points_m) {
        const std::size_t cell = cell_of(p_m);
        if (cell != kNoCell) z_m[next[cell]++] = p_m.z();
    }
    for (std::size_t i = 0; i < height_m.size(); ++i) {
        height_m.data()[i] =
            supported_height_m(std::span(z_m).subspan(first[i], first[i + 1] - first[i]));
    }
    return height_m;
}

}  // namespace

ScanArea area_around(const sim::ScriptedScene& script, double half_map_m) {
    constexpr double kStep_s = 0.5;
    const Eigen::Vector3d start_m = script.motion->at(0.0).T_world_body.translation_m;
    ScanArea area{start_m.head<2>(), start_m.head<2>(), 0.0};
    const double end_s = script.motion->duration_s();
    for (double t_s = 0.0; t_s < end_s + kStep_s; t_s += kStep_s) {
        const Eigen::Vector2d at_m =
            script.motion->at(std::min(t_s, end_s)).T_world_body.translation_m.head<2>();
        area.low_m = area.low_m.cwiseMin(at_m);
        area.high_m = area.high_m.cwiseMax(at_m);
    }
    for (const sim::Waypoint& stop : script.script.waypoints)
        area.ceiling_m = std::max(area.ceiling_m, stop.ground_z_m);
    area.ceiling_m += kCeiling_m;
    area.low_m.array() -= half_map_m;
    area.high_m.array() += half_map_m;
    return area;
}

Result<ScannedPlace> scan_place(const sim::ScriptedScene& script,
                                const sim::LaserScannerConfig& config,
                                std::uint64_t seed,
                                const ScanArea& area,
                                double resolution_m,
                                Executor& executor) {
    const auto scanner = sim::LaserScanner::make(script.scene, config, seed);
    if (!scanner) return scanner.error();
    const std::vector<Eigen::Vector3d> stations_m = stations_of(script);
    ScannedPlace place;
    std::vector<Eigen::Vector3f> points_m;
    for (const std::size_t i : near_stations(stations_m, area)) {
        Pose T_world_scanner;
        T_world_scanner.translation_m = stations_m[i];
        ++place.stations;
        StrayFilter filter(config);
        const StrayFilter::Take keep = [&](std::span<const Eigen::Vector3d> points_scanner_m) {
            for (const Eigen::Vector3d& p_scanner_m : points_scanner_m) {
                if (std::isnan(p_scanner_m.x())) continue;
                const Eigen::Vector3d p_m = T_world_scanner * p_scanner_m;
                if (holds(area, p_m)) points_m.push_back(p_m.cast<float>());
            }
            return !interrupted();
        };
        scanner->scan(
            T_world_scanner, static_cast<int>(i), executor, [&](const sim::ScanColumn& column) {
                return filter.add(column, keep);
            });
        filter.finish(keep);
        if (interrupted()) return Error{ErrorCode::interrupted, "interrupted by the user"};
    }
    if (points_m.empty()) {
        return input_error(
            fmt::format("{}: the laser scan has no point near the path", script.info.name));
    }
    place.scanned = static_cast<std::int64_t>(points_m.size());
    points_m = eval::voxel_means_m(points_m, kVoxel_m, executor);
    place.points_m = without_outliers(std::move(points_m), executor);
    place.geometry = cells_of(area, resolution_m);
    place.height_m = heights_of(place.points_m, place.geometry);
    return place;
}

}  // namespace surefoot::app
