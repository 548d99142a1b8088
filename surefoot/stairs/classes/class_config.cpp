// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/class_config.hpp"

#include <fmt/format.h>

namespace surefoot::stairs {

void ClassConfig::describe(ConfigVisitor& visitor) {
    visitor.number("headroom_m",
                   headroom_m,
                   0.0,
                   10.0,
                   "smallest free height above ground; ground with less free height is a tunnel");
    visitor.number("max_step_m",
                   max_step_m,
                   0.01,
                   1.0,
                   "largest height difference that one step can overcome, up or down");
    visitor.number("level_deg",
                   level_deg,
                   0.1,
                   45.0,
                   "largest slope of level ground; steeper ground is a ramp");
    visitor.number(
        "ramp_deg", ramp_deg, 0.1, 60.0, "largest slope of a ramp; steeper ground is not walkable");
    visitor.number("min_table_m",
                   min_table_m,
                   0.0,
                   5.0,
                   "smallest width of a table; narrower raised objects are walls");
    visitor.number("max_table_m",
                   max_table_m,
                   0.1,
                   10.0,
                   "largest height of a table; higher raised objects are walls");
    visitor.number("max_sigma_m",
                   max_sigma_m,
                   0.001,
                   1.0,
                   "largest height sigma of a cell with a walkable class; with a larger sigma "
                   "such a cell becomes unknown");
    visitor.number(
        "reach_m",
        reach_m,
        0.1,
        10.0,
        "largest distance from a cell to reachable ground that affects the class of the cell");
}

std::optional<std::string> ClassConfig::problem() const {
    if (level_deg < ramp_deg) return std::nullopt;
    return fmt::format("stairs.classes.level_deg {} must be below stairs.classes.ramp_deg {}",
                       level_deg,
                       ramp_deg);
}

}  // namespace surefoot::stairs
