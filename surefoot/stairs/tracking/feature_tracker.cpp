// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/feature_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

/// Two copies of a value of one observation differ by less than this, because of rounding.
constexpr double kSame_m = 1e-3;

/// Returns the edge of a drop or kerb.
Edge edge_of(const LineFeature& line) {
    const Vector2d way(std::cos(line.pose.yaw_rad), std::sin(line.pose.yaw_rad));
    const bool goes_down = line.height_m < 0.0;
    const Vector2d down = goes_down ? way : Vector2d(-way);
    const Vector2d along(-down.y(), down.x());
    const double behind_m = line.pose.p_m.z() + line.height_m;
    Edge edge;
    edge.from_m = line.pose.p_m.head<2>() - 0.5 * line.length_m * along;
    edge.to_m = line.pose.p_m.head<2>() + 0.5 * line.length_m * along;
    edge.upper_m = goes_down ? line.pose.p_m.z() : behind_m;
    edge.lower_m = goes_down ? behind_m : line.pose.p_m.z();
    edge.lower_seen = line.bottom_seen;
    edge.height_sigma_m = line.sigma_m;
    edge.across_sigma_m = line.across_sigma_m;
    edge.angle_sigma_rad = line.across_sigma_m / std::max(0.5 * line.length_m, kSame_m);
    return edge;
}

}  // namespace

FeatureTracker::FeatureTracker(const TrackingConfig& config)
    : edges_(config), flights_(config), doors_(config), sills_(config) {}

FeatureTracker::FeatureTracker(const StairsConfig& config)
    : edges_(config.tracking, config),
      flights_(config.tracking),
      doors_(config.tracking),
      sills_(config.tracking) {}

void FeatureTracker::forget() {
    edges_.forget();
    flights_.forget();
    doors_.forget();
    sills_.forget();
    nothing_yet_ = true;
}

void FeatureTracker::update(const TerrainFeatures& found,
                            const Terrain& terrain,
                            const Moment& now,
                            TerrainFeatures& out) {
    if (!now.drift.is_bounded()) forget();
    const Drift drift = now.drift.is_bounded() ? now.drift : Drift{};
    const bool first = nothing_yet_;
    nothing_yet_ = false;
    gather(found);
    edges_.update(seen_, terrain, now.time_ns, drift, first, ids_);
    gather_flights(found);
    flights_.update(std::span<const Flight>(seen_flights_).first(flight_count_),
                    edges_,
                    terrain,
                    now.time_ns,
                    first,
                    ids_);
    doors_.update(found.doors, terrain, now.time_ns, drift, first, ids_);
    sills_.update(found.sills, terrain, now.time_ns, drift, first, ids_);
    out.time_ns = now.time_ns;
    write_edges(out);
    flights_.write(terrain.stance_m, out.flights);
    doors_.write(terrain.stance_m, out.doors);
    sills_.write(terrain.stance_m, out.sills);
}

/// Collects the edges of an observation. An edge keeps its identity when its class changes, so
/// drops, kerbs and steps are looked up among the edges. An edge that is missing there is added.
void FeatureTracker::gather(const TerrainFeatures& found) {
    seen_.clear();
    for (const Edge& edge : found.edges) seen_.push_back({.edge = edge});
    for (const Flight& flight : found.flights)
        for (const Edge& edge : flight.edges) (void)seen_edge(edge);
    for (const LineFeature& drop : found.drops) seen_[seen_edge(edge_of(drop))].drop = true;
    for (const LineFeature& kerb : found.kerbs) {
        ObservedEdge& seen = seen_[seen_edge(edge_of(kerb))];
        seen.kerb = true;
        seen.kerb_down = kerb.height_m < 0.0;
    }
    std::erase_if(seen_, [](const ObservedEdge& seen) {
        const Edge& edge = seen.edge;
        return !edge.from_m.allFinite() || !edge.to_m.allFinite() || !(edge.length_m() > 0.0) ||
               !std::isfinite(edge.upper_m) || !std::isfinite(edge.lower_m) ||
               !std::isfinite(edge.across_sigma_m) || !std::isfinite(edge.height_sigma_m) ||
               !std::isfinite(edge.angle_sigma_rad);
    });
}

std::size_t FeatureTracker::seen_edge(const Edge& edge) {
    const auto same = std::find_if(seen_.begin(), seen_.end(), [&](const ObservedEdge& seen) {
        return (seen.edge.from_m - edge.from_m).squaredNorm() < kSame_m * kSame_m &&
               (seen.edge.to_m - edge.to_m).squaredNorm() < kSame_m * kSame_m;
    });
    if (same != seen_.end()) return static_cast<std::size_t>(same - seen_.begin());
    seen_.push_back({.edge = edge});
    return seen_.size() - 1;
}

void FeatureTracker::gather_flights(const TerrainFeatures& found) {
    flight_count_ = 0;
    if (seen_flights_.size() < found.flights.size()) seen_flights_.resize(found.flights.size());
    for (const Flight& flight : found.flights) {
        if (flight.edges.empty()) continue;
        Flight& seen = seen_flights_[flight_count_++];
        seen = flight;
        for (Edge& edge : seen.edges) {
            const std::size_t i = seen_edge(edge);
            edge.tracked.id = i < edges_.ids_of_seen().size() ? edges_.ids_of_seen()[i] : 0;
        }
    }
}

void FeatureTracker::write_edges(TerrainFeatures& out) const {
    out.edges.clear();
    out.drops.clear();
    out.kerbs.clear();
    for (const EdgeTrack& track : edges_.tracks()) {
        if (!track.shown) continue;
        out.edges.push_back(track.edge);
        if (track.drop) out.drops.push_back(line_feature(track.edge, true));
        if (track.kerb) out.kerbs.push_back(line_feature(track.edge, track.kerb_down));
    }
}

}  // namespace surefoot::stairs
