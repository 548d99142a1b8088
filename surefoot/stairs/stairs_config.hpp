// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/core/config.hpp"
#include "surefoot/stairs/classes/class_config.hpp"
#include "surefoot/stairs/classes/planar_patches.hpp"
#include "surefoot/stairs/doors/doors.hpp"
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

/// What counts as an edge, a step, a kerb. Lengths are those of building codes (NZ D1/AS1 Table 6,
/// ADA 504: docs of the scenes) with some room around them.
struct StairsConfig {
    double min_height_m = 0.04;  ///< of an edge: a kerb of 75 mm with 3.4 sigma of 10 mm
    double sigma_factor = 3.4;   ///< an edge stands out of the noise of both its sides, 3e-4
    /// A matcher spreads a kerb over up to five cells of 25 mm.
    double smear_m = 0.15;
    double min_length_m = 0.30;  ///< of an edge: 12 cells
    double fit_tolerance_m = 0.03;
    double max_gap_m = 0.20;  ///< within one edge, where nothing is known of it
    /// A shadow behind an edge is at most so many times as long as the edge is high: 2.5 m away
    /// from a camera 1 m above the ground.
    double shadow_per_height = 2.5;
    /// 1: cells hold the highest of all that they touch; 0: what is at their middle.
    double cell_reach = 1.0;

    double min_riser_m = 0.08;
    double max_riser_m = 0.23;
    double min_going_m = 0.15;
    double max_going_m = 0.55;
    double min_width_m = 0.45;     ///< of a flight
    double max_turn_deg = 40.0;    ///< from one edge to the next; more than 10 is a spiral
    double max_facing_deg = 60.0;  ///< of a single step: one walks towards it, not along it
    double walk_step_m = 0.03;     ///< what one walks over without taking a step
    double kerb_m = 0.20;          ///< highest kerb
    double drop_m = 0.05;          ///< what goes down by more is a drop (the gate's limit)

    /// So many times more likely a step than smooth ground (StepEvidenceFinder) must the heights of
    /// an edge be for a flight or a kerb. A map has some thirty lines that might be one, and at
    /// most one map in thirty may invent one.
    double step_ratio = 1000.0;
    /// The same for a drop: one that is not told costs more than one too many. A drop whose ground
    /// is not seen is not asked.
    double drop_ratio = 0.01;
    /// One sigma of errors that cells within 0.1 m share: 3 mm, what a matcher errs by 1 m away.
    double evidence_shared_m = 0.003;

    DoorConfig doors;
    PatchConfig patches;
    ClassConfig classes;
    TrackingConfig tracking;

    void describe(ConfigVisitor& visitor);
    /// First reason why this cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::stairs
