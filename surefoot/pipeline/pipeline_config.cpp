// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/pipeline_config.hpp"

#include <fmt/format.h>

#include <cmath>

namespace surefoot::pipeline {

void PipelineConfig::describe(ConfigVisitor& visitor) {
    visitor.group("mount", mount);
    visitor.group("level", level);
    visitor.group("camera", camera);
    visitor.group("stereo", stereo);
    visitor.group("fine", fine);
    visitor.group("self_calibration", self_calibration);
    visitor.group("odometry", odometry);
    visitor.group("ground", ground);
    visitor.group("elevation", elevation);
    visitor.group("specular", specular);
    visitor.group("traversability", traversability);
    visitor.group("foothold", foothold);
    visitor.group("stairs", stairs);
}

std::optional<std::string> PipelineConfig::problem() const {
    if (auto found = stereo.problem()) return found;
    if (auto found = fine.problem()) return found;
    if (auto found = elevation.problem()) return found;
    // The gate's snapshot counts in 0.1 mm, so a cell must be a whole number of 0.1 mm.
    const double tenths = elevation.resolution_m * 1e4;
    if (std::abs(tenths - std::round(tenths)) > 1e-6) {
        return fmt::format(
            "elevation.resolution_m = {}: must be a whole number of 0.1 mm, for example 0.025",
            elevation.resolution_m);
    }
    if (auto found = specular.problem()) return found;
    if (auto found = foothold.problem()) return found;
    if (auto found = stairs.problem()) return found;
    return traversability.widened_to(elevation.resolution_m).problem(elevation.resolution_m);
}

}  // namespace surefoot::pipeline
