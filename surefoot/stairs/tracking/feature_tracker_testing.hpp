// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stairs/terrain_testing.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"

/// Shared by the tests of the feature tracker: edges, drops and flights of one observation.
namespace surefoot::stairs::testing {

inline constexpr double kSigma_m = 0.005;

/// An edge across x = `at_m`, the lower ground ahead.
inline Edge edge_ahead(double at_m,
                       double upper_m = 0.0,
                       double lower_m = -0.2,
                       double half_m = 0.5) {
    Edge edge;
    edge.from_m = {at_m, -half_m};
    edge.to_m = {at_m, half_m};
    edge.upper_m = upper_m;
    edge.lower_m = lower_m;
    edge.lower_seen = true;
    edge.height_sigma_m = kSigma_m;
    edge.across_sigma_m = kSigma_m;
    edge.angle_sigma_rad = 0.01;
    return edge;
}

inline TerrainFeatures edges_found(const std::vector<Edge>& edges) {
    TerrainFeatures found;
    found.edges = edges;
    return found;
}

inline TerrainFeatures drop_found(const Edge& edge) {
    TerrainFeatures found = edges_found({edge});
    found.drops = {line_feature(edge, true)};
    return found;
}

/// A flight up with `steps` steps from `first_m` on; each edge is its own and has no id.
inline Flight flight_up(int steps,
                        double first_m = 1.0,
                        double riser_m = 0.18,
                        double going_m = 0.3) {
    Flight flight;
    flight.steps = steps;
    flight.riser_m = riser_m;
    flight.riser_sigma_m = 0.001;
    flight.going_m = going_m;
    flight.going_sigma_m = 0.002;
    flight.width_m = 1.0;
    for (int k = 0; k < steps; ++k) {
        Edge edge = edge_ahead(first_m + k * going_m, (k + 1) * riser_m, k * riser_m);
        std::swap(edge.from_m, edge.to_m);  // the lower ground is before it
        flight.edges.push_back(edge);
    }
    flight.pose.p_m << first_m, 0.0, 0.0;
    return flight;
}

inline TerrainFeatures flight_found(const Flight& flight) {
    TerrainFeatures found = edges_found(flight.edges);
    found.flights = {flight};
    return found;
}

/// Observes a constant map every 0.1 s.
class Observations {
  public:
    explicit Observations(const testing::Ground& ground) : map_(ground, 0.0, {0.0, 0.0}) {}
    /// All cells are unknown.
    Observations() : Observations([](double, double) { return 0.0; }) { map_.height_m.fill(kNanF); }

    const TerrainFeatures& observation(const TerrainFeatures& found, const Drift& drift = {}) {
        time_ns_ += 100'000'000;
        tracker_.update(found, map_.terrain({0.0, 0.0}), {time_ns_, drift}, out_);
        return out_;
    }
    /// Makes the next observation not the first one.
    void observe_nothing() { observation({}); }

    [[nodiscard]] const TerrainFeatures& out() const { return out_; }
    [[nodiscard]] std::int64_t time_ns() const { return time_ns_; }
    FeatureTracker& tracker() { return tracker_; }

  private:
    TestMap map_;
    FeatureTracker tracker_{TrackingConfig{}};
    TerrainFeatures out_;
    std::int64_t time_ns_ = 0;
};

}  // namespace surefoot::stairs::testing
