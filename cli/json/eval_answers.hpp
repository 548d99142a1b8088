// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surefoot/eval/depth/depth_errors.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/trajectory/path_errors.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string trajectory_json(const eval::TrajectoryErrors& errors,
                                          const std::vector<eval::PathError>& by_length,
                                          const io::TrajectoryFile& estimate,
                                          const io::TrajectoryFile& truth);
[[nodiscard]] std::string maps_json(const eval::MapComparison& result);
/// Divisor that converts the codes of a ground-truth image to disparities in px.
struct TruthScale {
    double used = 1.0;
    std::optional<double> suspected;  ///< probably correct divisor, if `used` seems wrong
};
[[nodiscard]] std::string depth_json(const eval::DepthErrors& errors, const TruthScale& scale);

}  // namespace surefoot::app
