// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stairs/edges/edge_border.hpp"
#include "surefoot/stairs/edges/edge_profile.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Finds further steps before and behind a given step, and fits all of them together. Their edges
/// are parallel, so all cells together give the direction. Also finds edges that are too ragged to
/// form lines, such as the far steps of a stair.
///
/// Cuts the ground before and behind the seed into slices (EdgeProfiler). Level runs that lie a
/// step apart are treads. Edge points near the border of two treads belong to their edge. Robust
/// least squares (Huber weights) then fits the offsets of all edges and their common direction. The
/// ground is cut again and fitted again, twice.
class StepFitter {
  public:
    explicit StepFitter(const StairsConfig& config) : config_(config), profiler_(config) {}
    /// Writes the edges of the flight that contains `seed`, lowest first; none if the flight has
    /// fewer than two. Lines follow the cells (see StairsConfig::cell_reach).
    void fit(const Terrain& terrain, const Edge& seed, std::vector<Edge>& out);

  private:
    struct Tread {
        double begin_m = 0.0;  ///< begin across the seed's line; positive = lower side
        double end_m = 0.0;
        double height_m = 0.0;
        double sigma_m = 0.0;    ///< one sigma of the height
        double scatter_m = 0.0;  ///< standard deviation of a cell
    };
    struct Step {
        double at_m = 0.0;  ///< distance of its edge from the seed's line, positive downward
        Tread upper;
        Tread lower;
        double from_m = 0.0;  ///< extent along the edge, counted from the begin of the seed
        double to_m = 0.0;
        double rms_m = 0.0;
        int points = 0;
    };
    void find_treads(const Terrain& terrain, const EdgeLine& line);
    [[nodiscard]] static int level_run(const EdgeProfiler::Slices& all, int first);
    void add_tread(const EdgeProfiler::Slices& all, int first, int length, int margin);
    void join_treads();
    void find_steps(const Edge& seed);
    [[nodiscard]] bool grow(int& from, int way);
    void find_borders(const Terrain& terrain, const EdgeLine& line);
    [[nodiscard]] double place_steps();
    void measure_extents(const grid::GridGeometry& grid);

    StairsConfig config_;
    EdgeProfiler profiler_;
    double length_m_ = 0.0;
    bool sees_faces_ = false;  ///< the stance is on the side of the visible riser faces
    std::vector<Tread> treads_;
    std::vector<Step> steps_;
    std::vector<BorderPoint> borders_;
    std::vector<ParallelEdge> places_;
};

}  // namespace surefoot::stairs
