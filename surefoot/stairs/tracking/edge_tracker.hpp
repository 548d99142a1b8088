// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/edges/step_evidence.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/stairs/tracking/drift.hpp"
#include "surefoot/stairs/tracking/observation_weight.hpp"
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

/// An edge of one observation, with its classes in that observation.
struct ObservedEdge {
    Edge edge;
    bool drop = false;
    bool kerb = false;
    bool kerb_down = false;  ///< the kerb is crossed downward
};

/// A tracked edge: `edge` is the mean of its observations, with its current sigmas.
struct EdgeTrack {
    Edge edge;
    ObservationWeight across;
    ObservationWeight angle;
    ObservationWeight level;   ///< weight of the height of the upper ground
    ObservationWeight height;  ///< weight of the height difference
    double away_m = 0.0;       ///< distance from the stance
    bool shown = false;
    bool drop = false;  ///< the edge was a drop in at least one observation
    bool kerb = false;
    bool kerb_down = false;
    int kerb_observations = 0;
    int kerb_missed = 0;         ///< consecutive observations that found the edge, but no kerb
    int missed = 0;              ///< consecutive observations that did not find the edge
    int place_known = 0;         ///< misses in which the ground at the edge was known
    int level_observations = 0;  ///< consecutive observations that find level or smooth ground
};

/// Counts ids up from 1 for all features that are tracked together; 0 means "no id".
class IdCounter {
  public:
    [[nodiscard]] std::uint32_t next() { return ++last_; }

  private:
    std::uint32_t last_ = 0;
};

/// Tracks edges, and the drops and kerbs made of edges. Rules: see FeatureTracker.
class EdgeTracker {
  public:
    static constexpr std::size_t kMaxEdges = 128;

    /// `evidence`: the settings that distinguish a drop from smooth ground.
    explicit EdgeTracker(const TrackingConfig& config, const StairsConfig& evidence = {})
        : config_(config), least_log_ratio_(std::log(evidence.drop_ratio)), evidence_(evidence) {
        tracks_.reserve(kMaxEdges);
    }
    /// `first`: true for the very first observation, which needs no confirmation.
    void update(std::span<const ObservedEdge> seen,
                const Terrain& terrain,
                std::int64_t time_ns,
                const Drift& drift,
                bool first,
                IdCounter& ids);
    void forget() { tracks_.clear(); }

    /// The tracked edges, sorted by distance from the stance.
    [[nodiscard]] std::span<const EdgeTrack> tracks() const { return tracks_; }
    [[nodiscard]] const EdgeTrack* find(std::uint32_t id) const;
    /// The track id of each edge in the last call; 0 = too far away to be tracked.
    [[nodiscard]] std::span<const std::uint32_t> ids_of_seen() const { return id_of_seen_; }

  private:
    /// A tracked edge and an observed edge that may be the same.
    struct Pair {
        double cost = 0.0;
        std::size_t track = 0;
        std::size_t seen = 0;
    };

    void age(const Drift& drift, const Eigen::Vector2d& stance_m);
    void pair_up(std::span<const ObservedEdge> seen);
    void take_pieces(std::span<const ObservedEdge> seen);
    void take(const ObservedEdge& seen,
              const Terrain& terrain,
              std::int64_t time_ns,
              EdgeTrack& track);
    void take_ends(const Edge& seen, const Terrain& terrain, EdgeTrack& track) const;
    /// Returns the new id, or 0 if nearer edges occupy all tracks.
    std::uint32_t begin(const ObservedEdge& seen,
                        const Terrain& terrain,
                        std::int64_t time_ns,
                        bool first,
                        IdCounter& ids);
    [[nodiscard]] bool make_room_for(const EdgeTrack& track);
    void miss(const Terrain& terrain, EdgeTrack& track);
    [[nodiscard]] bool is_seen_to_be_smooth(const Terrain& terrain, const Edge& edge);
    [[nodiscard]] bool is_over(const Terrain& terrain, const EdgeTrack& track) const;
    [[nodiscard]] bool is_now_another(const EdgeTrack& track);
    void remove(const Terrain& terrain);

    TrackingConfig config_;
    double least_log_ratio_;
    StepEvidenceFinder evidence_;
    std::vector<EdgeTrack> tracks_;
    std::vector<Pair> pairs_;
    std::vector<int> track_of_seen_;  ///< -1 = no track yet
    std::vector<int> seen_of_track_;
    std::vector<std::uint32_t> id_of_seen_;
};

}  // namespace surefoot::stairs
