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
#include "surefoot/stairs/flights/sight_faces.hpp"
#include "surefoot/stairs/flights/sight_steps.hpp"
#include "surefoot/stairs/flights/step_fit.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/traversability/reachability.hpp"

namespace surefoot::stairs {

/// What the ground is: its edges, and what they make up. Looks at one map alone; what was seen
/// before and is not seen now, it does not know.
///
/// Holds the working memory; not thread-safe. The same result for the same map.
class FeatureFinder {
  public:
    explicit FeatureFinder(const StairsConfig& config);
    [[nodiscard]] const StairsConfig& config() const noexcept { return config_; }
    /// `config().problem()` is empty. Maps of fewer than 2 x 2 cells have no features.
    void find(const Terrain& terrain, TerrainFeatures& out);

  private:
    void find_edges(const Terrain& terrain, std::vector<Edge>& edges);
    /// Takes the steps of flights out of the edges and places them together.
    void fit_steps(const Terrain& terrain, std::vector<Edge>& edges);
    /// Places what goes up by what is seen of its faces.
    void see_faces(const Terrain& terrain, std::vector<Edge>& edges);
    /// Adds the steps down that the camera sees where the map holds fewer.
    void see_steps_down(const Terrain& terrain, std::vector<Edge>& edges);
    bool add_seen(std::vector<Edge>& edges);
    /// Takes out what smooth ground explains as well, and ends flights where that begins.
    void weigh(const Terrain& terrain, std::vector<Edge>& edges);
    void weigh_one(const Terrain& terrain, Edge& edge);
    void keep_steps(std::vector<Edge>& chain, std::vector<Edge>& edges) const;
    /// Measured alike, pieces of a ragged edge turn out to be one.
    void join_pieces(std::vector<Edge>& edges) const;
    /// Which sides of the edges can be walked to.
    void find_walkable(const Terrain& terrain, std::vector<Edge>& edges) const;
    [[nodiscard]] bool turns(std::span<const Edge> chain, std::span<const Edge> edges) const;
    [[nodiscard]] bool shares_a_step(std::span<const Edge> chain) const;
    void name_lines(const Terrain& terrain, TerrainFeatures& out) const;

    StairsConfig config_;
    EdgePointFinder point_finder_;
    EdgeLineFinder line_finder_;
    EdgeProfiler profiler_;
    StepFitter step_fitter_;
    SightFaces sight_faces_;
    SightSteps sight_steps_;
    StepEvidenceFinder evidence_;
    FlightFinder flight_finder_;
    FlightSides flight_sides_;
    DoorFinder door_finder_;
    traversability::Reachability reachability_;
    grid::Layer walk_step_m_;  ///< NaN = not to be walked to
    std::vector<EdgePoint> points_;
    std::vector<EdgeLine> lines_;
    std::vector<Edge> guesses_;  ///< lines of which the map does not show what lies below them
    std::vector<Edge> from_above_;
    std::vector<Edge> seen_;
    std::vector<std::vector<Edge>> chains_;  ///< of steps placed together
    std::vector<bool> in_flight_;
};

}  // namespace surefoot::stairs
