// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/simulation/sim_options.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Returns the positions of the scanner in the world [m]. They are those of the scene file, or one
/// position 1.6 m above the ground at the start of the path.
[[nodiscard]] std::vector<Eigen::Vector3d> stations_of(const sim::ScriptedScene& script);

/// Returns the expected number of points of all stations together. A coarse scan from each station
/// measures the share of beams that return.
[[nodiscard]] Result<double> expected_points(const sim::Scene& scene,
                                             const sim::LaserScannerConfig& config,
                                             std::span<const Eigen::Vector3d> stations_m,
                                             Executor& executor);

/// Expected size of a scan.
struct ScanSize {
    double points = 0.0;
    double bytes = 0.0;
};

/// Returns an input error if the scan needs more space on the disk than `free_bytes`.
[[nodiscard]] Status check_room(const std::string& file, const ScanSize& size, double free_bytes);

/// Progress of a scan, and the error that ended it early.
struct Scanned {
    std::string file;
    int stations = 0;  ///< number of started stations
    std::int64_t points = 0;
    int tiles = 0;  ///< number of tile files; 0 = one cloud file
    std::optional<Error> error;
};

/// Returns the result as JSON, see docs/reference/json.md.
[[nodiscard]] std::string scan_json(const Scanned& scanned);

/// Runs `surefoot sim --scan`: writes laser scans of a scene. Returns the exit code.
int scan(const SimOptions& options);

}  // namespace surefoot::app
