// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/pipeline_config.hpp"

#include <fmt/format.h>

#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::pipeline {

void PipelineConfig::describe(ConfigVisitor& visitor) {
    visitor.group("mount", mount);
    visitor.group("stereo", stereo);
    visitor.group("odometry", odometry);
    visitor.group("ground", ground);
    visitor.group("elevation", elevation);
    visitor.group("traversability", traversability);
}

std::optional<std::string> PipelineConfig::problem() const {
    constexpr int kMaxCellsPerSide = 4000;
    const double cells = elevation.length_m / elevation.resolution_m;
    if (cells > kMaxCellsPerSide) {
        return fmt::format(
            "elevation.length_m / elevation.resolution_m = {:.0f} cells a side exceeds {}: enlarge "
            "the cells or "
            "shorten the map",
            cells,
            kMaxCellsPerSide);
    }
    if (cells < 4) {
        return fmt::format(
            "elevation.length_m / elevation.resolution_m = {:.1f} cells a side: a map needs at "
            "least 4",
            cells);
    }
    return std::nullopt;
}

}  // namespace surefoot::pipeline
