// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/stairs/tracking/drift.hpp"
#include "surefoot/stairs/tracking/edge_tracker.hpp"
#include "surefoot/stairs/tracking/observation_weight.hpp"
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

/// Tracks features with a position and almost no extent: doors and sills. Two features match if
/// their middles lie within 0.3 m. Rules: see FeatureTracker.
template <typename Place>
class LocatedFeatureTracker {
  public:
    explicit LocatedFeatureTracker(const TrackingConfig& config) : config_(config) {}
    void update(std::span<const Place> seen,
                const Terrain& terrain,
                std::int64_t time_ns,
                const Drift& drift,
                bool first,
                IdCounter& ids);
    void forget() { tracks_.clear(); }
    /// Writes the shown features, nearest first.
    void write(const Eigen::Vector2d& stance_m, std::vector<Place>& out);

  private:
    struct Track {
        Place place;
        ObservationWeight across;  ///< weight of a door's width or of a sill's position across
        ObservationWeight height;  ///< weight of the height of the sill
        bool shown = false;
        int place_seen = 0;  ///< consecutive observations that see the location without the feature
    };

    void take(const Place& seen, std::int64_t time_ns, Track& track) const;
    [[nodiscard]] Track* nearest(const Place& seen);

    TrackingConfig config_;
    std::vector<Track> tracks_;
};

using DoorTracker = LocatedFeatureTracker<Door>;
using SillTracker = LocatedFeatureTracker<LineFeature>;

}  // namespace surefoot::stairs
