// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stairs/edges/edge_border.hpp"
#include "surefoot/stairs/edges/edge_profile.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Looks for further steps before and behind one of them, and places all of them together: their
/// edges are parallel, and each is seen by far more cells than tell its own direction. Finds edges
/// that are too ragged to be seen as lines: the map of a stair's far steps is.
///
/// The ground before and behind the seed is cut into slices (EdgeProfiler). Level pieces of it that
/// lie a step apart are treads; where one passes into the next, the edge points near that place
/// belong to the edge. Offsets of all edges and their common direction are then found by robust
/// least squares (Huber's weights), the ground cut again, twice.
class StepFitter {
  public:
    explicit StepFitter(const StairsConfig& config) : config_(config), profiler_(config) {}
    /// Edges of the flight that `seed` belongs to, lowest first; fewer than two if it has no
    /// neighbours. Lines lie where the cells have them (see StairsConfig::cell_reach).
    void fit(const Terrain& terrain, const Edge& seed, std::vector<Edge>& out);

  private:
    struct Tread {
        double begin_m = 0.0;  ///< along the way down
        double end_m = 0.0;
        double height_m = 0.0;
        double sigma_m = 0.0;    ///< of the height
        double scatter_m = 0.0;  ///< of a cell
    };
    struct Step {
        double at_m = 0.0;  ///< of its edge, from the seed's line along the way down
        Tread upper;
        Tread lower;
        double from_m = 0.0;  ///< extent along the edge, from the seed's beginning
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
    bool sees_faces_ = false;  ///< the stance is where risers show their faces
    std::vector<Tread> treads_;
    std::vector<Step> steps_;
    std::vector<BorderPoint> borders_;
    std::vector<ParallelEdge> places_;
};

}  // namespace surefoot::stairs
