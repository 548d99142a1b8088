// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/stairs/doors/doors.hpp"
#include "surefoot/stairs/edges/edge_lines.hpp"
#include "surefoot/stairs/edges/edge_points.hpp"
#include "surefoot/stairs/edges/edge_profile.hpp"
#include "surefoot/stairs/edges/step_evidence.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/flights/flight_sides.hpp"
#include "surefoot/stairs/flights/flights.hpp"
#include "surefoot/stairs/flights/ray_faces.hpp"
#include "surefoot/stairs/flights/ray_steps.hpp"
#include "surefoot/stairs/flights/step_fit.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/traversability/reachability.hpp"

namespace surefoot::stairs {

/// Finds the terrain features of one map: edges, flights, kerbs, drops and doors. It has no memory
/// of earlier maps (see FeatureTracker). The same map gives the same result.
///
/// Owns the working memory. Not thread-safe.
class FeatureFinder {
  public:
    explicit FeatureFinder(const StairsConfig& config);
    [[nodiscard]] const StairsConfig& config() const noexcept { return config_; }
    /// Precondition: `config().problem()` is empty. Maps below 2 x 2 cells have no features.
    void find(const Terrain& terrain, TerrainFeatures& out);

  private:
    void find_edges(const Terrain& terrain, std::vector<Edge>& edges);
    /// Moves the steps of flights from `edges` to `chains_` and fits each flight as a whole.
    void fit_steps(const Terrain& terrain, std::vector<Edge>& edges);
    /// Places risers that face the camera by the visible points of their faces.
    void see_faces(const Terrain& terrain, std::vector<Edge>& edges);
    /// Adds steps down that the camera sees and the map lacks.
    void see_steps_down(const Terrain& terrain, std::vector<Edge>& edges);
    bool add_seen(std::vector<Edge>& edges);
    /// Removes edges that smooth ground explains much better (`drop_ratio`), also from flights.
    void weigh(const Terrain& terrain, std::vector<Edge>& edges);
    void weigh_one(const Terrain& terrain, Edge& edge);
    void keep_steps(std::vector<Edge>& chain, std::vector<Edge>& edges) const;
    /// Joins the pieces of one ragged edge if their heights agree.
    void join_pieces(std::vector<Edge>& edges) const;
    /// Marks the sides of each edge that can be walked to from the stance.
    void find_walkable(const Terrain& terrain, std::vector<Edge>& edges) const;
    [[nodiscard]] bool turns(std::span<const Edge> chain, std::span<const Edge> edges) const;
    [[nodiscard]] bool shares_a_step(std::span<const Edge> chain) const;
    void name_lines(const Terrain& terrain, TerrainFeatures& out) const;

    StairsConfig config_;
    EdgePointFinder point_finder_;
    EdgeLineFinder line_finder_;
    EdgeProfiler profiler_;
    StepFitter step_fitter_;
    RayFaces ray_faces_;
    RaySteps ray_steps_;
    StepEvidenceFinder evidence_;
    FlightFinder flight_finder_;
    FlightSides flight_sides_;
    DoorFinder door_finder_;
    traversability::Reachability reachability_;
    grid::Layer walk_step_m_;  ///< reach_step_m of Reachability; NaN = unknown or not reachable
    std::vector<EdgePoint> points_;
    std::vector<EdgeLine> lines_;
    std::vector<Edge> guesses_;  ///< edges whose fall the map does not show
    std::vector<Edge> from_above_;
    std::vector<Edge> seen_;
    std::vector<std::vector<Edge>> chains_;  ///< edges of steps that were placed together
    std::vector<bool> in_flight_;
};

}  // namespace surefoot::stairs
