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

/// Positions of the scanner in the world [m]: those of the scene file, or one position above the
/// start of the path.
[[nodiscard]] std::vector<Eigen::Vector3d> stations_of(const sim::ScriptedScene& script);

/// Expected number of points of all stations together. The share of beams that return is measured
/// with a coarse scan from each station.
[[nodiscard]] Result<double> expected_points(const sim::Scene& scene,
                                             const sim::LaserScannerConfig& config,
                                             std::span<const Eigen::Vector3d> stations_m,
                                             Executor& executor);

/// Expected size of a scan.
struct ScanSize {
    double points = 0.0;
    double bytes = 0.0;
};

/// Input error if the scan does not fit on the disk. `free_bytes` is the free space.
[[nodiscard]] Status check_room(const std::string& file, const ScanSize& size, double free_bytes);

/// Progress of a scan, and the reason why it ended early.
struct Scanned {
    std::string file;
    int stations = 0;  ///< stations that were started
    std::int64_t points = 0;
    int tiles = 0;  ///< tile files; 0 = one cloud file
    std::optional<Error> error;
};

/// The result as JSON, see docs/reference/json.md.
[[nodiscard]] std::string scan_json(const Scanned& scanned);

/// `surefoot sim --scan`: writes terrestrial laser scans of a scene. Returns the exit code.
int scan(const SimOptions& options);

}  // namespace surefoot::app
