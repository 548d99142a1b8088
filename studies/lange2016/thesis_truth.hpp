// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Area of a place to scan.
struct ScanArea {
    Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
    double ceiling_m = 0.0;    ///< higher points are left out, as in the filter of the map
    double farthest_m = 15.0;  ///< largest distance of a used station from the area
};
/// Returns the area that the map of a run may cover: points within half a map length of the path.
[[nodiscard]] ScanArea area_around(const sim::ScriptedScene& script, double half_map_m);

/// Laser scan of a place, processed as in chapter 8 of the reference thesis (Lange 2016). Steps:
/// remove stray points of each station; place the stations by their true poses; thin to 1 mm;
/// remove outliers (7 points including the point itself, 4 sigma); compute heights on a grid.
struct ScannedPlace {
    std::vector<Eigen::Vector3f> points_m;  ///< points without outliers, in world coordinates
    grid::GridGeometry geometry;
    grid::Layer height_m;  ///< highest supported surface of each cell
    int stations = 0;
    std::int64_t scanned = 0;  ///< points in the area before thinning, stray points excluded
};
/// Scans the area. Returns an error if the scanner configuration is not valid, if the area contains
/// no point, or if the user interrupts.
[[nodiscard]] Result<ScannedPlace> scan_place(const sim::ScriptedScene& script,
                                              const sim::LaserScannerConfig& config,
                                              std::uint64_t seed,
                                              const ScanArea& area,
                                              double resolution_m,
                                              Executor& executor);

}  // namespace surefoot::app
