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

/// An edge as one look found it, with what it was called.
struct ObservedEdge {
    Edge edge;
    bool drop = false;
    bool kerb = false;
    bool kerb_down = false;  ///< met by who goes down
};

/// An edge over several looks: `edge` is their mean, its sigmas as of now.
struct EdgeTrack {
    Edge edge;
    ObservationWeight across;
    ObservationWeight angle;
    ObservationWeight level;   ///< of the upper ground
    ObservationWeight height;  ///< of the difference
    double away_m = 0.0;       ///< from the stance
    bool shown = false;
    bool drop = false;  ///< it was called one once
    bool kerb = false;
    bool kerb_down = false;
    int kerb_observations = 0;
    int kerb_missed = 0;         ///< looks in a row that found it and called it no kerb
    int missed = 0;              ///< looks in a row that did not find it
    int place_known = 0;         ///< of these, those that know the ground at its place
    int level_observations = 0;  ///< in a row, that know the ground and find it level or smooth
};

/// Counts the ids of all features that are followed together; 0 is none.
class IdCounter {
  public:
    [[nodiscard]] std::uint32_t next() { return ++last_; }

  private:
    std::uint32_t last_ = 0;
};

/// Follows edges, and the drops and kerbs that they are. Rules: FeatureTracker.
class EdgeTracker {
  public:
    static constexpr std::size_t kMaxEdges = 128;

    /// `evidence`: what tells a drop from smooth ground (StepEvidenceFinder).
    explicit EdgeTracker(const TrackingConfig& config, const StairsConfig& evidence = {})
        : config_(config), least_log_ratio_(std::log(evidence.drop_ratio)), evidence_(evidence) {
        tracks_.reserve(kMaxEdges);
    }
    /// `first`: nothing was looked at before, so that nothing can be asked for twice.
    void update(std::span<const ObservedEdge> seen,
                const Terrain& terrain,
                std::int64_t time_ns,
                const Drift& drift,
                bool first,
                IdCounter& ids);
    void forget() { tracks_.clear(); }

    /// Nearest to the stance first.
    [[nodiscard]] std::span<const EdgeTrack> tracks() const { return tracks_; }
    [[nodiscard]] const EdgeTrack* find(std::uint32_t id) const;
    /// The track of each edge that was seen in the last call; 0 = it was too far away for any.
    [[nodiscard]] std::span<const std::uint32_t> ids_of_seen() const { return id_of_seen_; }

  private:
    /// An edge that is followed and one that is seen, which may be the same.
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
    /// Returns its id, or 0 where there is no room for it.
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
    std::vector<int> track_of_seen_;  ///< -1 = none yet
    std::vector<int> seen_of_track_;
    std::vector<std::uint32_t> id_of_seen_;
};

}  // namespace surefoot::stairs
