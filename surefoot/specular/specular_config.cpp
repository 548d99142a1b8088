// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/specular_config.hpp"

#include <fmt/format.h>

namespace surefoot::specular {

void SpecularConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean("enabled", enabled, "looks for mirrors and glass that stand on the floor");
    visitor.number("cell_m", cell_m, 0.005, 0.02, "cells of the picture of the floor");
    visitor.number("range_m", range_m, 1.0, 5.0, "farthest floor that enters the picture");
    visitor.number(
        "mirror_correlation", mirror_correlation, 0.1, 1.0, "of a floor with its mirror image");
    visitor.number("mirror_score", mirror_score, 4.0, 50.0, "makes a mirror's line suspected");
    visitor.number("glass_score", glass_score, 4.0, 50.0, "makes a line of glass suspected");
    visitor.number("keep_score", keep_score, 0.0, 50.0, "least score of a line that stays");
    visitor.integer("forget_observations", forget_looks, 1, 100, "looks below it until it is forgotten");
    visitor.number(
        "unique_ratio", unique_ratio, 1.0, 10.0, "best line over the next best one, in score");
    visitor.integer("directions_per_frame",
                    directions_per_frame,
                    1,
                    180,
                    "looks ahead in a frame, and all around");
    visitor.number("margin_m", margin_m, 0.0, 0.5, "unknown before the line");
    visitor.number("side_margin_m", side_margin_m, 0.0, 1.0, "unknown beside the line");
}

std::optional<std::string> SpecularConfig::problem() const {
    if (keep_score <= mirror_score && keep_score <= glass_score) return std::nullopt;
    return fmt::format(
        "specular.keep_score = {}: must exceed neither specular.mirror_score = {} nor "
        "specular.glass_score = {}",
        keep_score,
        mirror_score,
        glass_score);
}

}  // namespace surefoot::specular
