// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/stairs/tracking/drift.hpp"
#include "surefoot/stairs/tracking/edge_tracker.hpp"
#include "surefoot/stairs/tracking/flight_tracker.hpp"
#include "surefoot/stairs/tracking/located_feature_tracker.hpp"
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

/// When a look was taken, and what the machine's motion since the last look leaves unsure.
struct Moment {
    std::int64_t time_ns = 0;
    Drift drift;
};

/// What the ground is, over time: what looks (FeatureFinder) find is put together by its place,
/// gets an id, and is reported as the mean of its looks. In odom.
///
/// - Edges are the same where they agree across, in direction, in both heights and in the ground
///   that they share: within 3.4 sigma, or half a step where sigmas are smaller. Flights are the
///   same where their edges are, doors and sills where they stand.
/// - A mean is steadier than its looks but no surer than the best one (ObservationWeight): all of
/// them are
///   looks at one map. What was not found in this look has sigmas that grow with the drift.
/// - Unknown is never safe. A drop is reported from the first look on, not farther away than this
///   look says by more than its sigma, and as long as it is. It goes when `level_observations`
///   looks in a row know level ground on both sides of it, or see smooth ground that slopes, when
///   it has left the map, or when as many looks in a row found it just beside, as another edge. One
///   that this look finds is always reported (of more than EdgeTracker::kMaxEdges the nearest).
/// - All else is reported from the second look on: a wrong match has the sigma of a right one, but
///   not twice the same place. (In the first look after nothing there was none to ask.) It goes
///   when looks see its place and do not find it, `missed_observations` times in a row.
/// - A flight has as many steps as most of the last looks say. Its going hangs on where each look
///   sees the faces of risers; those errors change, and the mean of many looks is surer than any
///   (RobustMean).
///
/// Kerbs and drops have the ids of their edges. Ids are never used twice, not even after `forget`.
/// Looks of one place and size allocate nothing after the first few. Not thread-safe.
class FeatureTracker {
  public:
    explicit FeatureTracker(const TrackingConfig& config);
    /// With the settings by which the finder tells a drop from smooth ground.
    explicit FeatureTracker(const StairsConfig& config);

    /// `found`: by a look at `terrain`. Its order does not matter but for ties. A drift that is not
    /// bounded forgets all that came before.
    void update(const TerrainFeatures& found,
                const Terrain& terrain,
                const Moment& now,
                TerrainFeatures& out);
    /// Odom is another one, or nobody knows where the machine is.
    void forget();

  private:
    void gather(const TerrainFeatures& found);
    [[nodiscard]] std::size_t seen_edge(const Edge& edge);
    void gather_flights(const TerrainFeatures& found);
    void write_edges(TerrainFeatures& out) const;

    EdgeTracker edges_;
    FlightTracker flights_;
    DoorTracker doors_;
    SillTracker sills_;
    IdCounter ids_;
    bool nothing_yet_ = true;
    std::vector<ObservedEdge> seen_;
    std::vector<Flight> seen_flights_;  ///< with the ids of their edges; keeps its memory
    std::size_t flight_count_ = 0;
};

}  // namespace surefoot::stairs
