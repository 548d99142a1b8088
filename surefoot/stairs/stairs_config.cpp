// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/stairs_config.hpp"

#include <fmt/format.h>

namespace surefoot::stairs {

void StairsConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "min_height_m", min_height_m, 0.005, 1.0, "smallest height of an edge that is reported");
    visitor.number("sigma_factor",
                   sigma_factor,
                   1.0,
                   10.0,
                   "smallest height of an edge, as a multiple of its sigma (noise of both sides)");
    visitor.number("smear_m",
                   smear_m,
                   0.01,
                   0.5,
                   "largest width over which the map may smear the height change of an edge");
    visitor.number("min_length_m", min_length_m, 0.05, 5.0, "smallest length of an edge");
    visitor.number("fit_tolerance_m",
                   fit_tolerance_m,
                   0.002,
                   0.2,
                   "largest distance of an edge point from the line of its edge");
    visitor.number(
        "max_gap_m", max_gap_m, 0.0, 2.0, "largest gap without edge points within one edge");
    visitor.number("shadow_per_height",
                   shadow_per_height,
                   0.0,
                   20.0,
                   "largest horizontal length of the occluded region behind an edge, per metre of "
                   "edge height");
    visitor.number(
        "cell_reach",
        cell_reach,
        0.0,
        1.0,
        "height that a map cell holds: 0 = height at its centre, 1 = highest point of its area");
    visitor.number(
        "min_riser_m", min_riser_m, 0.01, 1.0, "smallest median height of the steps of a flight");
    visitor.number("max_riser_m", max_riser_m, 0.02, 1.0, "largest height of a step of a flight");
    visitor.number(
        "min_going_m", min_going_m, 0.05, 2.0, "smallest depth of a tread, from nosing to nosing");
    visitor.number("max_going_m",
                   max_going_m,
                   0.1,
                   5.0,
                   "largest depth of a tread; a deeper tread is a landing");
    visitor.number("min_width_m", min_width_m, 0.1, 5.0, "smallest width of a flight");
    visitor.number("max_turn_deg",
                   max_turn_deg,
                   0.0,
                   60.0,
                   "largest angle between the edges of neighbouring steps");
    visitor.number(
        "max_facing_deg",
        max_facing_deg,
        10.0,
        90.0,
        "largest angle between the normal of a single step and the straight way from the "
        "machine to this step; at a larger angle the step is not a flight");
    visitor.number("walk_step_m",
                   walk_step_m,
                   0.01,
                   0.5,
                   "largest height difference between neighbouring cells that counts as walkable "
                   "ground without a step");
    visitor.number("kerb_m", kerb_m, 0.02, 1.0, "largest height of a kerb");
    visitor.number(
        "drop_m", drop_m, 0.01, 1.0, "a fall to lower ground by more than this height is a drop");
    visitor.number("step_ratio",
                   step_ratio,
                   0.0,
                   1e12,
                   "smallest likelihood ratio (step to smooth ground) of an edge that counts as a "
                   "step; 0 = no such check");
    visitor.number("drop_ratio",
                   drop_ratio,
                   0.0,
                   1e12,
                   "smallest likelihood ratio (step to smooth ground) of a drop; an edge with a "
                   "smaller ratio counts as smooth ground; 0 = no such check");
    visitor.number("evidence_shared_m",
                   evidence_shared_m,
                   0.0001,
                   0.1,
                   "one sigma of the height error that cells within 0.1 m share; affects the "
                   "likelihood ratios of steps and drops");
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
            "stairs.drop_ratio {} must not exceed stairs.step_ratio {}, "
            "because every step down counts as a drop",
            drop_ratio,
            step_ratio);
    if (auto found = doors.problem()) return found;
    if (auto found = patches.problem()) return found;
    return classes.problem();
}

}  // namespace surefoot::stairs
