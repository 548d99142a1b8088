// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/disc_runs.hpp"
#include "surefoot/traversability/traversability_config.hpp"

/// The two passes of the step filter over a block of rows. Compiled for every instruction set
/// and selected at run time; all give the same bytes. step.hpp has the plain version of the
/// formulas.
namespace surefoot::traversability::rows {

/// Two figures of each run (such as lowest and highest height); one lane per neighbouring column.
struct alignas(64) StepRun {
    static constexpr int kLanes = 16;
    float figures[2][kLanes];
};

/// Gives the same bytes as traversability::step_heights, for discs of more than one cell. `ring`
/// holds RunsOfDiscs::kept_runs() elements.
void step_heights(const PaddedLayer& height_m,
                  const RunsOfDiscs& widths,
                  const DiscRuns& first_disc,
                  const CellRect& rect,
                  StepRun* ring,
                  PaddedLayer& step_height_m);

/// Computes traversability::rate_step in single precision: the same unknown cells and zeros, and
/// all other ratings within 3e-7.
void rate_step(const TraversabilityConfig::Step& config,
               const PaddedLayer& step_height_m,
               const RunsOfDiscs& widths,
               const DiscRuns& second_disc,
               const CellRect& rect,
               StepRun* ring,
               grid::Layer& step);

}  // namespace surefoot::traversability::rows
