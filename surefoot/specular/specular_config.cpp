// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/specular_config.hpp"

#include <fmt/format.h>

namespace surefoot::specular {

void SpecularConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean("enabled", enabled, "search for mirrors and glass that stand on the floor");
    visitor.number("cell_m", cell_m, 0.005, 0.02, "cell size of the floor picture");
    visitor.number("range_m", range_m, 1.0, 5.0, "largest distance of floor in the picture");
    visitor.number("mirror_correlation",
                   mirror_correlation,
                   0.1,
                   1.0,
                   "floor and image: a mirror from this on");
    visitor.number(
        "mirror_score", mirror_score, 4.0, 50.0, "score from which a mirror is suspected");
    visitor.number("glass_score", glass_score, 4.0, 50.0, "score from which glass is suspected");
    visitor.number("keep_score", keep_score, 0.0, 50.0, "least score to keep a suspected line");
    visitor.integer("forget_observations",
                    forget_looks,
                    1,
                    100,
                    "observations below keep_score before a line is removed");
    visitor.number("unique_ratio",
                   unique_ratio,
                   1.0,
                   10.0,
                   "least ratio of the best score to the second best");
    visitor.integer("directions_per_frame",
                    directions_per_frame,
                    1,
                    180,
                    "directions searched ahead per frame, and as many all around");
    visitor.number("margin_m", margin_m, 0.0, 0.5, "cells this far before the line become unknown");
    visitor.number(
        "side_margin_m", side_margin_m, 0.0, 1.0, "cells this far beside the line become unknown");
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
