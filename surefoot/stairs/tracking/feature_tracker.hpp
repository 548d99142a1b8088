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

/// The time of an observation, and the uncertainty of the motion since the previous observation.
struct Moment {
    std::int64_t time_ns = 0;
    Drift drift;
};

/// Tracks features over time, in odom. Joins the observations (FeatureFinder) of one feature under
/// one id and reports their mean.
///
/// - Two edges are the same if they agree within 3.4 sigma. This gate is at least 75 mm across the
///   edge, 40 mm in height and 20 deg, and at most 0.25 m, 80 mm and 40 deg. Both must share 30 %
///   of the shorter length. Flights match by their edges, doors and sills by their position.
/// - A mean is steadier than its observations, but its sigma is not below the best of them
///   (ObservationWeight), because all observations read one map. Between observations the sigmas
///   grow with the drift.
/// - Drops are reported from the first observation on, never farther away than the current
///   observation plus its sigma, and at full length. A drop ends when it leaves the map. It also
///   ends after `level_observations` consecutive observations of level or smooth ground on both
///   sides, or of another edge just beside it. Every drop of the current observation is reported
///   (the nearest EdgeTracker::kMaxEdges, if there are more).
/// - All other features need two observations, because a wrong match rarely repeats its
///   position. (The very first observation needs no second one.) They end after
///   `missed_observations` consecutive observations that see their location without them.
/// - The last observations vote on the number of steps. A going depends on visible riser
///   faces. Their errors change between frames, so the sigma of RobustMean may be below that
///   of its observations.
///
/// Kerbs and drops have the ids of their edges. No id is used twice, not even after `forget`.
/// With one map size and number of features, only the first few calls allocate. Not thread-safe.
class FeatureTracker {
  public:
    explicit FeatureTracker(const TrackingConfig& config);
    /// Uses the settings by which the finder distinguishes a drop from smooth ground.
    explicit FeatureTracker(const StairsConfig& config);

    /// `found`: the features of an observation of `terrain`, in any order (order decides ties
    /// only). A drift that is not bounded discards all tracks.
    void update(const TerrainFeatures& found,
                const Terrain& terrain,
                const Moment& now,
                TerrainFeatures& out);
    /// Discards all tracks. Call it when odom restarts or the machine's pose is lost.
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
    std::vector<Flight> seen_flights_;  ///< flights with their edges' ids; the memory is reused
    std::size_t flight_count_ = 0;
};

}  // namespace surefoot::stairs
