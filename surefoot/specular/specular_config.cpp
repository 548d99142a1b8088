// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/specular_config.hpp"

#include <fmt/format.h>

namespace surefoot::specular {

void SpecularConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "enabled", enabled, "true: search for mirrors and glass that stand on the floor");
    visitor.number("cell_m", cell_m, 0.005, 0.02, "cell size of the floor picture");
    visitor.number(
        "range_m", range_m, 1.0, 5.0, "largest distance of the floor in the floor picture");
    visitor.number("mirror_correlation",
                   mirror_correlation,
                   0.1,
                   1.0,
                   "smallest correlation between the floor and its image in a mirror; a line with "
                   "less is not a mirror");
    visitor.number(
        "mirror_score", mirror_score, 4.0, 50.0, "smallest score at which a mirror is suspected");
    visitor.number(
        "glass_score", glass_score, 4.0, 50.0, "smallest score at which glass is suspected");
    visitor.number(
        "keep_score", keep_score, 0.0, 50.0, "smallest score at which a suspected line is kept");
    visitor.integer("forget_observations",
                    forget_looks,
                    1,
                    100,
                    "number of observations below keep_score after which a line is removed");
    visitor.number("unique_ratio",
                   unique_ratio,
                   1.0,
                   10.0,
                   "smallest ratio of the best score to the second best score");
    visitor.integer("directions_per_frame",
                    directions_per_frame,
                    1,
                    180,
                    "number of directions searched ahead in each frame; the same number is "
                    "searched all around");
    visitor.number("margin_m",
                   margin_m,
                   0.0,
                   0.5,
                   "distance before the line within which cells become unknown");
    visitor.number("side_margin_m",
                   side_margin_m,
                   0.0,
                   1.0,
                   "distance beside the line within which cells become unknown");
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
