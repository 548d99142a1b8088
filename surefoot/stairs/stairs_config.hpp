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

/// Definition of an edge, a step, a kerb and a drop. The sizes of steps follow building codes (NZ
/// D1/AS1 Table 6, ADA 504) with a margin.
struct StairsConfig {
    double min_height_m = 0.04;  ///< smallest edge: a 75 mm kerb minus 3.4 sigma of 10 mm
    double sigma_factor = 3.4;   ///< smallest edge height in sigma; noise exceeds it with p = 3e-4
    /// Largest width of an edge in the map. Default: six cells of 25 mm; a kerb smears over five.
    double smear_m = 0.15;
    double min_length_m = 0.30;  ///< smallest length of an edge: 12 cells of 25 mm
    double fit_tolerance_m = 0.03;
    double max_gap_m = 0.20;  ///< largest gap without edge points within one edge
    /// Largest horizontal length of the occluded region behind an edge, per metre of edge height.
    /// The default is for an edge 2.5 m away from a camera 1 m above the ground.
    double shadow_per_height = 2.5;
    /// 1: a cell holds the highest point of its area. 0: a cell holds the height at its centre.
    double cell_reach = 1.0;

    double min_riser_m = 0.08;
    double max_riser_m = 0.23;
    double min_going_m = 0.15;
    double max_going_m = 0.55;
    double min_width_m = 0.45;     ///< smallest width of a flight
    double max_turn_deg = 40.0;    ///< largest turn between neighbouring edges; spirals exceed 10
    double max_facing_deg = 60.0;  ///< largest angle of a single step's normal to the way to it
    double walk_step_m = 0.03;     ///< largest height difference that needs no step
    double kerb_m = 0.20;          ///< highest kerb
    double drop_m = 0.05;          ///< a fall by more than this is a drop (the limit of the gate)

    /// Smallest likelihood ratio "step" over "smooth ground" (StepEvidenceFinder) of a kerb, of a
    /// single step and of at least half of the steps of a flight. A map has about thirty candidate
    /// lines, and at most one map in thirty may contain a false step.
    double step_ratio = 1000.0;
    /// Smallest likelihood ratio of a drop. It is low, because a missed drop costs more than a
    /// false one. A drop whose lower ground is not seen is not tested.
    double drop_ratio = 0.01;
    /// One sigma of errors that cells within 0.1 m share: 3 mm, the matcher's error at 1 m.
    double evidence_shared_m = 0.003;

    DoorConfig doors;
    PatchConfig patches;
    ClassConfig classes;
    TrackingConfig tracking;

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why these settings are invalid, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::stairs
