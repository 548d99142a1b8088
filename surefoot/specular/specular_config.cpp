// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/specular_config.hpp"

#include <fmt/format.h>

namespace surefoot::specular {

void SpecularConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "enabled", enabled, "true: search for mirrors and glass that stand on the floor");
    visitor.number("cell_m",
                   cell_m,
                   0.005,
                   0.02,
                   "side length of a cell of the floor picture, which is a top view of the floor");
    visitor.number("range_m",
                   range_m,
                   1.0,
                   5.0,
                   "largest depth along the optical axis at which floor enters the floor picture");
    visitor.number("mirror_correlation",
                   mirror_correlation,
                   0.1,
                   1.0,
                   "smallest correlation between the floor and its image in a mirror; a line with "
                   "less can only be glass");
    visitor.number(
        "mirror_score",
        mirror_score,
        4.0,
        50.0,
        "smallest score at which a line is suspected to be a mirror [sigma of the noise]");
    visitor.number("glass_score",
                   glass_score,
                   4.0,
                   50.0,
                   "smallest score at which a line is suspected to be glass [sigma of the noise]");
    visitor.number("keep_score",
                   keep_score,
                   0.0,
                   50.0,
                   "smallest score at which a suspected line is kept [sigma of the noise]");
    visitor.integer(
        "forget_observations",
        forget_observations,
        1,
        100,
        "number of consecutive observations below keep_score after which a line is removed");
    visitor.number("unique_ratio",
                   unique_ratio,
                   1.0,
                   10.0,
                   "smallest ratio of the best line's score to the second best line's score at "
                   "which the best line is suspected; glass needs a ratio of at least 2");
    visitor.integer("directions_per_frame",
                    directions_per_frame,
                    1,
                    180,
                    "number of directions searched ahead in each frame; the same number is "
                    "searched all around");
    visitor.number(
        "margin_m",
        margin_m,
        0.0,
        0.5,
        "map cells up to this distance before a suspected mirror or pane become unknown, like the "
        "cells behind it");
    visitor.number(
        "side_margin_m",
        side_margin_m,
        0.0,
        1.0,
        "map cells up to this distance beside a suspected mirror or pane become unknown; behind it "
        "the distance grows");
}

std::optional<std::string> SpecularConfig::problem() const {
    if (keep_score <= mirror_score && keep_score <= glass_score) return std::nullopt;
    return fmt::format(
        "specular.keep_score = {} must be at most specular.mirror_score = {} and at most "
        "specular.glass_score = {}",
        keep_score,
        mirror_score,
        glass_score);
}

}  // namespace surefoot::specular
