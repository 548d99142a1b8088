// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Where the scanner stands: as the scene says, or over the start of its way.
[[nodiscard]] std::vector<Eigen::Vector3d> stations_of(const sim::ScriptedScene& script);

/// Points that all stations together will give: the share of beams that come back, looked at on a
/// coarse fan from each.
[[nodiscard]] Result<double> expected_points(const sim::Scene& scene,
                                             const sim::LaserScannerConfig& config,
                                             std::span<const Eigen::Vector3d> stations_m,
                                             Executor& executor);

/// What a scan is expected to write.
struct ScanSize {
    double points = 0.0;
    double bytes = 0.0;
};

/// Refuses a scan that the disk has no room for.
[[nodiscard]] Status check_room(const std::string& file, const ScanSize& size, double free_bytes);

/// How far scanning a scene got, and why it ended early.
struct Scanned {
    std::string file;
    int stations = 0;  ///< that were begun
    std::int64_t points = 0;
    int tiles = 0;  ///< files of it; 0 = one cloud
    std::optional<Error> error;
};

}  // namespace surefoot::app
