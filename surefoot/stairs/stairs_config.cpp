// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/stairs_config.hpp"

#include <fmt/format.h>

namespace surefoot::stairs {

void StairsConfig::describe(ConfigVisitor& visitor) {
    visitor.number("min_height_m", min_height_m, 0.005, 1.0, "lowest edge that is reported");
    visitor.number("sigma_factor", sigma_factor, 1.0, 10.0, "an edge exceeds the noise by");
    visitor.number("smear_m", smear_m, 0.01, 0.5, "an edge may be spread over");
    visitor.number("min_length_m", min_length_m, 0.05, 5.0, "shortest edge");
    visitor.number("fit_tolerance_m",
                   fit_tolerance_m,
                   0.002,
                   0.2,
                   "largest distance of a point from its edge");
    visitor.number("max_gap_m", max_gap_m, 0.0, 2.0, "largest unknown gap within one edge");
    visitor.number("shadow_per_height",
                   shadow_per_height,
                   0.0,
                   20.0,
                   "deepest occluded region behind an edge, per metre of its height");
    visitor.number("cell_reach",
                   cell_reach,
                   0.0,
                   1.0,
                   "0: cells take the height at their centre, 1: the highest anywhere in them");
    visitor.number(
        "min_riser_m", min_riser_m, 0.01, 1.0, "lowest step of a flight, except the first");
    visitor.number("max_riser_m", max_riser_m, 0.02, 1.0, "highest step of a flight");
    visitor.number("min_going_m", min_going_m, 0.05, 2.0, "shortest tread, from nosing to nosing");
    visitor.number("max_going_m", max_going_m, 0.1, 5.0, "deepest tread; more is a landing");
    visitor.number("min_width_m", min_width_m, 0.1, 5.0, "narrowest flight");
    visitor.number(
        "max_turn_deg", max_turn_deg, 0.0, 60.0, "between the edges of neighbouring steps");
    visitor.number("max_facing_deg",
                   max_facing_deg,
                   10.0,
                   90.0,
                   "a single step seen at a larger angle is no flight");
    visitor.number(
        "walk_step_m",
        walk_step_m,
        0.01,
        0.5,
        "neighbouring cells that differ by no more than this are walked over without a step");
    visitor.number("kerb_m", kerb_m, 0.02, 1.0, "highest kerb");
    visitor.number("drop_m", drop_m, 0.01, 1.0, "ground that is lower by more than this is a drop");
    visitor.number("step_ratio",
                   step_ratio,
                   0.0,
                   1e12,
                   "likelihood ratio of step over smooth ground that makes an edge a step; "
                   "0: every edge");
    visitor.number(
        "drop_ratio", drop_ratio, 0.0, 1e12, "the same ratio that makes an edge down a drop");
    visitor.number("evidence_shared_m",
                   evidence_shared_m,
                   0.0001,
                   0.1,
                   "one sigma of errors that cells within 0.1 m share, for both ratios");
    visitor.group("doors", doors);
    visitor.group("patches", patches);
    visitor.group("classes", classes);
    visitor.group("tracking", tracking);
}

std::optional<std::string> StairsConfig::problem() const {
    if (!(min_riser_m < max_riser_m))
        return fmt::format(
            "stairs.min_riser_m {} must be below stairs.max_riser_m {}", min_riser_m, max_riser_m);
    if (!(min_going_m < max_going_m))
        return fmt::format(
            "stairs.min_going_m {} must be below stairs.max_going_m {}", min_going_m, max_going_m);
    if (!(drop_ratio <= step_ratio))
        return fmt::format(
            "stairs.drop_ratio {} must not exceed stairs.step_ratio {}: a step down is a drop",
            drop_ratio,
            step_ratio);
    if (auto found = doors.problem()) return found;
    if (auto found = patches.problem()) return found;
    return classes.problem();
}

}  // namespace surefoot::stairs
