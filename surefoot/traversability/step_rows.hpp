// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/disc_runs.hpp"
#include "surefoot/traversability/traversability_config.hpp"

/// The two passes of the step filter over a block of rows, compiled once for every instruction set
/// and chosen at run time; all give the same bytes. What they compute is written plainly in
/// step.hpp.
namespace surefoot::traversability::rows {

/// Two figures of the runs of one half width around neighbouring columns.
struct alignas(64) StepRun {
    static constexpr int kLanes = 16;
    float figures[2][kLanes];
};

/// The same bytes as traversability::step_heights, for discs of more than one cell. `ring` holds
/// RunsOfDiscs::kept_runs() elements.
void step_heights(const PaddedLayer& height_m,
                  const RunsOfDiscs& widths,
                  const DiscRuns& first_disc,
                  const CellRect& rect,
                  StepRun* ring,
                  PaddedLayer& step_height_m);

/// traversability::rate_step in single precision: known where that is, 0 where that is, and within
/// 3e-7 of it.
void rate_step(const TraversabilityConfig::Step& config,
               const PaddedLayer& step_height_m,
               const RunsOfDiscs& widths,
               const DiscRuns& second_disc,
               const CellRect& rect,
               StepRun* ring,
               grid::Layer& step);

}  // namespace surefoot::traversability::rows
