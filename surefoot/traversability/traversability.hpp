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

/// Result per cell; NaN = unknown. Normals are unit vectors in the frame of the map, z >= 0; the
/// other layers are ratings from 1 (traversable) to 0 (not traversable).
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

/// Implementation of the filters.
enum class Way : std::uint8_t {
    fast,   ///< runs of cells, for every instruction set (step_rows, surface_rows)
    plain,  ///< cell by cell; reference for tests and timings of `fast`
};

/// Rates a height map: normals -> slope, step, roughness -> weighted sum (Wermelinger et al. 2016).
/// Keeps its working memory: maps of one size allocate nothing after the first. Every executor and
/// every processor gives the same bytes. Cost: cells times radii. With a disc radius above
/// DiscRuns::kMaxReach cells, or a single-cell disc for normals or step heights, it uses the plain
/// filters (cells times disc sizes). Not thread-safe.
class Traversability {
  public:
    /// Rows of one work item for the executor.
    static constexpr int kBlockRows = 40;

    explicit Traversability(const TraversabilityConfig& config, Way way = Way::fast)
        : config_(config), way_(way) {}
    [[nodiscard]] const TraversabilityConfig& config() const noexcept { return config_; }

    /// Rates all cells of `height_m` (NaN = unknown; one row per iy, cell size `resolution_m` > 0).
    void rate(ImageView<const float> height_m,
              double resolution_m,
              Executor& executor,
              TraversabilityLayers& out);

    /// Rates only the cells of `region` and leaves the other cells of `out` unchanged. The ratings
    /// equal those of a rating of the whole map. If `out` has another size than the map, all cells
    /// are rated.
    void rate(ImageView<const float> height_m,
              double resolution_m,
              const CellRect& region,
              Executor& executor,
              TraversabilityLayers& out);

    /// Step heights of the cells rated last: highest minus lowest height within the first disc [m],
    /// pass 1 of the step filter; NaN = unknown.
    [[nodiscard]] const PaddedLayer& rated_step_heights() const noexcept { return step_height_; }

    /// Returns the cells whose ratings may change with the heights in `changed` (not clipped to the
    /// map).
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
    RunsOfDiscs surface_runs_;  ///< runs for normals and roughness
    RunsOfDiscs first_runs_;
    RunsOfDiscs second_runs_;
    // Kept runs, one part for each block of rows.
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
