// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/disc_runs.hpp"
#include "surefoot/traversability/step_rows.hpp"
#include "surefoot/traversability/surface_rows.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// What is known about every cell; NaN = unknown. Normals are unit vectors in the frame of the map,
/// z >= 0; the rest are ratings from 1 (traversable) to 0 (not).
struct TraversabilityLayers {
    grid::Layer normal_x;
    grid::Layer normal_y;
    grid::Layer normal_z;
    grid::Layer slope;
    grid::Layer step;
    grid::Layer roughness;
    grid::Layer traversability;

    void resize(int nx, int ny);
    [[nodiscard]] bool has_size(int nx, int ny) const noexcept;
};

/// How the filters are worked out.
enum class Way : std::uint8_t {
    fast,   ///< by runs of cells, for every instruction set (step_rows, surface_rows)
    plain,  ///< cell by cell; what the fast way is tested and timed against
};

/// Rates a height map: normals -> slope, step, roughness -> weighted sum (Wermelinger et al. 2016).
/// Holds the working memory, so that rating maps of one size allocates nothing after the first.
/// Results are the same bytes for every executor and every processor. Cost: proportional to cells
/// times radii. Discs of more than DiscRuns::kMaxReach cells, and first discs of a single cell, are
/// left to the plain filters (cells times disc sizes).
class Traversability {
  public:
    /// Blocks of rows that are one piece of work for the executor.
    static constexpr int kBlockRows = 40;

    explicit Traversability(const TraversabilityConfig& config, Way way = Way::fast)
        : config_(config), way_(way) {}
    [[nodiscard]] const TraversabilityConfig& config() const noexcept { return config_; }

    /// Rates all cells of `height_m` (NaN = unknown; one row per iy, cell size `resolution_m` > 0).
    void rate(ImageView<const float> height_m,
              double resolution_m,
              Executor& executor,
              TraversabilityLayers& out);

    /// Rates the cells of `region` only and leaves the others of `out` as they are; the region gets
    /// the values that rating the whole map would give it. If `out` has another size than the map,
    /// all cells are rated.
    void rate(ImageView<const float> height_m,
              double resolution_m,
              const CellRect& region,
              Executor& executor,
              TraversabilityLayers& out);

    /// Highest minus lowest within the first disc [m], pass 1 of the step filter, of the cells
    /// rated last; NaN = unknown.
    [[nodiscard]] const PaddedLayer& rated_step_heights() const noexcept { return step_height_; }

    /// The cells whose ratings can differ after the heights in `changed` have changed (not
    /// clipped).
    [[nodiscard]] CellRect affected_by(const CellRect& changed, double resolution_m) const noexcept;

  private:
    [[nodiscard]] bool fast_can(double resolution_m) const noexcept;
    void rate_fast(double resolution_m,
                   const CellRect& wide,
                   const CellRect& rect,
                   Executor& executor,
                   TraversabilityLayers& out);
    void rate_plainly(double resolution_m,
                      const CellRect& wide,
                      const CellRect& rect,
                      Executor& executor,
                      TraversabilityLayers& out);

    TraversabilityConfig config_;
    Way way_;
    PaddedLayer height_;
    PaddedLayer step_height_;  ///< pass 1 of the step filter
    Disc normals_disc_;
    Disc first_step_disc_;
    Disc second_step_disc_;
    Disc roughness_disc_;
    DiscRuns normals_runs_;
    DiscRuns first_step_runs_;
    DiscRuns second_step_runs_;
    DiscRuns roughness_runs_;
    RunsOfDiscs surface_runs_;  ///< of normals and roughness
    RunsOfDiscs first_runs_;
    RunsOfDiscs second_runs_;
    // Kept runs, one portion for each block of rows.
    std::vector<rows::RunSums> surface_rings_;
    std::vector<rows::StepRun> step_rings_;
};

/// Rates one map with fresh working memory.
void rate(const TraversabilityConfig& config,
          ImageView<const float> height_m,
          double resolution_m,
          Executor& executor,
          TraversabilityLayers& out);

}  // namespace surefoot::traversability
