// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/stairs/tracking/drift.hpp"
#include "surefoot/stairs/tracking/edge_follower.hpp"
#include "surefoot/stairs/tracking/follow_config.hpp"
#include "surefoot/stairs/tracking/look_weight.hpp"

namespace surefoot::stairs {

/// Follows what has a place and hardly an extent: doors, sills. Two are the same where their
/// middles lie within 0.3 m. Rules: FeatureFollower.
template <typename Place>
class PlaceFollower {
  public:
    explicit PlaceFollower(const FollowConfig& config) : config_(config) {}
    void follow(std::span<const Place> seen,
                const Terrain& terrain,
                std::int64_t time_ns,
                const Drift& drift,
                bool first,
                IdCounter& ids);
    void forget() { tracks_.clear(); }
    /// Those that are shown, nearest first.
    void write(const Eigen::Vector2d& stance_m, std::vector<Place>& out);

  private:
    struct Track {
        Place place;
        LookWeight across;  ///< of doors the width, of sills where they lie
        LookWeight height;  ///< of the sill
        bool shown = false;
        int place_seen = 0;  ///< looks in a row that see its place and do not find it
    };

    void take(const Place& seen, std::int64_t time_ns, Track& track) const;
    [[nodiscard]] Track* nearest(const Place& seen);

    FollowConfig config_;
    std::vector<Track> tracks_;
};

using DoorFollower = PlaceFollower<Door>;
using SillFollower = PlaceFollower<LineFeature>;

}  // namespace surefoot::stairs
