// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"
#include "surefoot/stairs/tracking/edge_tracker.hpp"
#include "surefoot/stairs/tracking/observation_weight.hpp"
#include "surefoot/stairs/tracking/robust_mean.hpp"
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

/// A tracked flight.
struct FlightTrack {
    static constexpr int kMaxSteps = 64;

    /// Last observed flight with `flight.steps` steps; its riser, going and width are means.
    Flight flight;
    ObservationWeight riser;
    RobustMean going;
    ObservationWeight width;
    /// Votes for each number of steps; recent observations weigh most.
    std::array<float, kMaxSteps + 1> votes{};
    bool shown = false;
    int missed = 0;
    int place_seen = 0;  ///< observations since the last match that see its location
};

/// Tracks flights; two match if they share at least half of the shorter one's edges.
class FlightTracker {
  public:
    explicit FlightTracker(const TrackingConfig& config) : config_(config) {}
    /// The edges of `seen` carry the ids of `edges`.
    void update(std::span<const Flight> seen,
                const EdgeTracker& edges,
                const Terrain& terrain,
                std::int64_t time_ns,
                bool first,
                IdCounter& ids);
    void forget();
    /// Writes the shown flights, nearest first; `out` keeps its memory. A separate track of a
    /// flight's far end is written as a part of that flight.
    void write(const Eigen::Vector2d& stance_m, std::vector<Flight>& out);

  private:
    struct Pair {
        int common = 0;
        std::size_t track = 0;
        std::size_t seen = 0;
    };

    /// A track that is the far end of the flight of another track.
    struct FarEnd {
        std::size_t track = 0;
        std::size_t host = 0;
    };

    void pair_up(std::span<const Flight> seen);
    void take(const Flight& seen, std::int64_t time_ns, FlightTrack& track) const;
    [[nodiscard]] bool is_over(int edges_left, const Terrain& terrain, FlightTrack& track) const;
    /// A removed track keeps the memory of its edges for later use.
    void remove(std::size_t track);
    FlightTrack& add();

    TrackingConfig config_;
    std::vector<FlightTrack> tracks_;
    std::vector<FlightTrack> spare_;
    std::vector<Flight> spare_flights_;
    std::vector<Pair> pairs_;
    std::vector<int> track_of_seen_;
    std::vector<bool> track_seen_;
    std::vector<std::size_t> order_;
    std::vector<FarEnd> far_ends_;
};

}  // namespace surefoot::stairs
