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

/// What of a place is scanned.
struct ScanArea {
    Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
    double ceiling_m = 0.0;    ///< higher points are left out, as the map's own filter does
    double farthest_m = 15.0;  ///< stations farther from the area are left out
};
/// What the map of a run may reach: everything within half a map around the way.
[[nodiscard]] ScanArea area_around(const sim::ScriptedScene& script, double half_map_m);

/// The laser scan of a place as chapter 8 of the thesis makes it, stray points of each station left
/// out first: stations registered, thinned to 1 mm, statistical outliers removed (7 points, the
/// point among them, 4 sigma), heights on 25 mm.
struct ScannedPlace {
    std::vector<Eigen::Vector3f> points_m;  ///< cleaned, in the world
    grid::GridGeometry geometry;
    grid::Layer height_m;  ///< highest surface of each cell that its points agree on
    int stations = 0;
    std::int64_t scanned = 0;  ///< points in the area, without strays
};
/// Errors: a scanner that sees nothing; no point in the area.
[[nodiscard]] Result<ScannedPlace> scan_place(const sim::ScriptedScene& script,
                                              const sim::LaserScannerConfig& config,
                                              std::uint64_t seed,
                                              const ScanArea& area,
                                              double resolution_m,
                                              Executor& executor);

}  // namespace surefoot::app
