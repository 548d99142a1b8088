// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/flight_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/stairs/edges/edge_place.hpp"
#include "surefoot/stairs/edges/edge_relations.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kWidthSigma_m = 0.05;  ///< one sigma from noise and occlusion at the ends of edges
/// One sigma of the going error that all observations share. Texture biases the matcher in the same
/// way each time.
constexpr double kGoingShared_m = 0.0015;
/// Smallest lead in votes that changes the number of steps. Two alternating numbers do not change
/// it.
constexpr float kLead = 1.0F;
/// Edges that lie more than this number of risers off the line of a flight belong to another
/// flight, behind a landing.
constexpr double kFarEnd_risers = 1.5;

int common_edges(const Flight& a, const Flight& b) {
    int common = 0;
    for (const Edge& edge : a.edges)
        common += edge.tracked.id != 0 &&
                  std::any_of(b.edges.begin(), b.edges.end(), [&](const Edge& other) {
                      return other.tracked.id == edge.tracked.id;
                  });
    return common;
}

void take_mean(
    double observation, double sigma, double most, ObservationWeight& weight, double& mean) {
    if (!std::isfinite(observation) || !std::isfinite(sigma)) return;
    const double before = std::isfinite(mean) ? mean : observation;
    mean = before + weight.take(sigma * sigma, observation - before, most) * (observation - before);
}

int steps_of(const Flight& flight) {
    return std::clamp(flight.steps, 0, FlightTrack::kMaxSteps);
}

/// Adds a vote for `steps`. Returns true if this number of steps is reported.
bool vote(int steps, double most_observations, FlightTrack& track) {
    const auto keep = static_cast<float>(1.0 - 1.0 / most_observations);
    for (float& votes : track.votes) votes *= keep;
    const auto at = [&](int n) -> float& { return track.votes[static_cast<std::size_t>(n)]; };
    at(steps) += 1.0F;
    const int shown = steps_of(track.flight);
    return steps == shown || at(steps) > at(shown) + kLead;
}

double distance_m(const Flight& flight, const Vector2d& stance_m) {
    const double away_m = (flight.pose.p_m.head<2>() - stance_m).norm();
    return std::isfinite(away_m) ? away_m : std::numeric_limits<double>::max();
}

/// Updates pose and turn of a flight whose edges have moved.
void place(Flight& flight) {
    const Edge& first = flight.edges.front();
    const Edge& last = flight.edges.back();
    const bool up = flight.kind == FlightKind::up;
    Vector2d down = Vector2d::Zero();
    for (const Edge& edge : flight.edges) down += std::pow(edge.length_m(), 3) * edge.down();
    const Vector2d a = first.down();
    const Vector2d b = last.down();
    flight.turn_rad = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    flight.pose.p_m << first.middle_m(), up ? first.lower_m : first.upper_m;
    flight.pose.yaw_rad = up ? std::atan2(-down.y(), -down.x()) : std::atan2(down.y(), down.x());
}

/// Copies the tracked edges into the flight. Returns the number of edges that are still tracked.
int refresh(const EdgeTracker& edges, Flight& flight) {
    int left = 0;
    for (Edge& edge : flight.edges) {
        const EdgeTrack* const track = edges.find(edge.tracked.id);
        if (track == nullptr) {
            edge.tracked.seen_now = false;
            continue;
        }
        edge = track->edge;
        ++left;
    }
    if (!flight.edges.empty()) place(flight);
    return left;
}

/// Returns the number of steps of `flight` before the separately observed far end `end`. 0 = `end`
/// is another flight.
int steps_before(const Flight& end, const Flight& flight) {
    if (end.kind != flight.kind || flight.steps < 2 || !(flight.going_m > 0.0)) return 0;
    const Edge& first = flight.edges.front();
    const Edge& begin = end.edges.front();
    const double way = flight.kind == FlightKind::up ? 1.0 : -1.0;
    const double behind_m = -way * first.below_m(begin.middle_m());
    const double rise_m = way * (end.pose.p_m.z() - flight.pose.p_m.z());
    const double foretold_m = flight.riser_m * behind_m / flight.going_m;
    const bool leads_there =
        behind_m > 0.5 * flight.going_m && is_parallel(first, begin) &&
        overlap_m(first, begin) >= 0.5 * std::min(first.length_m(), begin.length_m()) &&
        std::abs(rise_m - foretold_m) <= kFarEnd_risers * flight.riser_m;
    if (!leads_there) return 0;
    const int steps = saturated_integer<int>(std::round(rise_m / flight.riser_m));
    return steps <= static_cast<int>(flight.edges.size()) ? std::max(steps, 0) : 0;
}

/// Replaces the steps at the far end of the flight by the separately observed steps.
void take_far_end(const Flight& end, int steps_before, Flight& flight) {
    flight.edges.resize(static_cast<std::size_t>(steps_before));
    flight.edges.insert(flight.edges.end(), end.edges.begin(), end.edges.end());
    flight.steps = steps_before + end.steps;
    flight.landing_m = end.landing_m;
    flight.cut = end.cut;
    place(flight);
}

}  // namespace

void FlightTracker::forget() {
    while (!tracks_.empty()) remove(tracks_.size() - 1);
}

void FlightTracker::remove(std::size_t track) {
    std::swap(tracks_[track], tracks_.back());
    spare_.push_back(std::move(tracks_.back()));
    tracks_.pop_back();
}

FlightTrack& FlightTracker::add() {
    FlightTrack track;
    if (!spare_.empty()) {
        track.flight.edges = std::move(spare_.back().flight.edges);
        spare_.pop_back();
    }
    tracks_.push_back(std::move(track));
    return tracks_.back();
}

void FlightTracker::update(std::span<const Flight> seen,
                           const EdgeTracker& edges,
                           const Terrain& terrain,
                           std::int64_t time_ns,
                           bool first,
                           IdCounter& ids) {
    pair_up(seen);
    for (FlightTrack& track : tracks_) track.flight.tracked.seen_now = false;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (track_of_seen_[i] >= 0) {
            take(seen[i], time_ns, tracks_[static_cast<std::size_t>(track_of_seen_[i])]);
            continue;
        }
        FlightTrack& track = add();
        // `take` fills the new track and counts its first observation, so the count begins at 0.
        track.flight.tracked = {.id = ids.next(), .observations = 0};
        track.flight.going_m = track.flight.riser_m = track.flight.width_m = std::nan("");
        take(seen[i], time_ns, track);
        track.shown = first;
    }
    for (std::size_t t = 0; t < tracks_.size();) {
        const int edges_left = refresh(edges, tracks_[t].flight);
        if (is_over(edges_left, terrain, tracks_[t])) {
            remove(t);
        } else {
            ++t;
        }
    }
}

void FlightTracker::pair_up(std::span<const Flight> seen) {
    pairs_.clear();
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const Flight& flight = tracks_[t].flight;
        for (std::size_t s = 0; s < seen.size(); ++s) {
            if (flight.kind != seen[s].kind) continue;
            const int common = common_edges(flight, seen[s]);
            const auto fewer =
                static_cast<int>(std::min(flight.edges.size(), seen[s].edges.size()));
            if (common > 0 && 2 * common >= fewer) pairs_.push_back({common, t, s});
        }
    }
    std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
        if (a.common != b.common) return a.common > b.common;
        return a.track != b.track ? a.track < b.track : a.seen < b.seen;
    });
    track_of_seen_.assign(seen.size(), -1);
    track_seen_.assign(tracks_.size(), false);
    for (const Pair& pair : pairs_) {
        if (track_of_seen_[pair.seen] >= 0 || track_seen_[pair.track]) continue;
        track_of_seen_[pair.seen] = static_cast<int>(pair.track);
        track_seen_[pair.track] = true;
    }
}

void FlightTracker::take(const Flight& seen, std::int64_t time_ns, FlightTrack& track) const {
    Flight& flight = track.flight;
    const Tracked before = flight.tracked;
    double riser_m = flight.riser_m;
    double width_m = flight.width_m;
    take_mean(seen.riser_m, seen.riser_sigma_m, config_.mean_observations, track.riser, riser_m);
    take_mean(seen.width_m, kWidthSigma_m, config_.mean_observations, track.width, width_m);
    if (std::isfinite(seen.going_m) && seen.going_sigma_m > 0.0)
        track.going.add(seen.going_m, seen.going_sigma_m, config_.going_observations);
    const FlightSide left = seen.left.kind == SideKind::unknown ? flight.left : seen.left;
    const FlightSide right = seen.right.kind == SideKind::unknown ? flight.right : seen.right;
    if (vote(steps_of(seen), config_.steps_observations, track) || before.observations == 0)
        flight = seen;
    flight.riser_m = riser_m;
    flight.riser_sigma_m = track.riser.sigma();
    flight.width_m = width_m;
    flight.left = left;
    flight.right = right;
    flight.going_m = flight.going_sigma_m = std::nan("");
    if (flight.steps > 1 && !track.going.empty()) {
        const RobustMean::Mean going = track.going.mean(kGoingShared_m);
        flight.going_m = going.value;
        flight.going_sigma_m = going.sigma;
    }
    flight.tracked = {.id = before.id,
                      .observations = before.observations + 1,
                      .last_seen_ns = time_ns,
                      .seen_now = true};
    track.shown = track.shown || flight.tracked.observations >= 2;
    track.missed = track.place_seen = 0;
}

/// True if the flight has lost its edges, or is visible but no longer found. Also true if other
/// flights have taken its edges, for example after the machine has climbed it.
bool FlightTracker::is_over(int edges_left, const Terrain& terrain, FlightTrack& track) const {
    if (track.flight.tracked.seen_now) return false;
    ++track.missed;
    if (edges_left == 0) return true;
    if (is_observed(terrain, track.flight.pose.p_m)) ++track.place_seen;
    if (track.place_seen >=
        (track.shown ? config_.missed_observations : config_.first_observations))
        return true;
    if (track.missed < config_.level_observations) return false;
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const FlightTrack& other) {
        return other.flight.tracked.seen_now &&
               2 * common_edges(track.flight, other.flight) > track.flight.steps;
    });
}

void FlightTracker::write(const Vector2d& stance_m, std::vector<Flight>& out) {
    order_.clear();
    far_ends_.clear();
    const auto holds = [&](std::size_t host, std::size_t end) {
        return tracks_[host].shown && steps_before(tracks_[end].flight, tracks_[host].flight) > 0;
    };
    const auto is_end = [&](std::size_t t) {
        for (std::size_t host = 0; host < tracks_.size(); ++host)
            if (holds(host, t)) return true;
        return false;
    };
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        if (!tracks_[t].shown) continue;
        std::size_t host = 0;
        while (host < tracks_.size() && (!holds(host, t) || is_end(host))) ++host;
        if (host == tracks_.size())
            order_.push_back(t);
        else
            far_ends_.push_back({t, host});
    }
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
        const double a_m = distance_m(tracks_[a].flight, stance_m);
        const double b_m = distance_m(tracks_[b].flight, stance_m);
        return a_m != b_m ? a_m < b_m : tracks_[a].flight.tracked.id < tracks_[b].flight.tracked.id;
    });
    while (out.size() > order_.size()) {
        spare_flights_.push_back(std::move(out.back()));
        out.pop_back();
    }
    while (out.size() < order_.size()) {
        if (spare_flights_.empty()) {
            out.emplace_back();
        } else {
            out.push_back(std::move(spare_flights_.back()));
            spare_flights_.pop_back();
        }
    }
    for (std::size_t i = 0; i < order_.size(); ++i) {
        out[i] = tracks_[order_[i]].flight;
        for (const FarEnd& end : far_ends_) {
            const Flight& seen = tracks_[end.track].flight;
            if (end.host != order_[i]) continue;
            if (const int steps = steps_before(seen, out[i]); steps > 0)
                take_far_end(seen, steps, out[i]);
        }
    }
}

}  // namespace surefoot::stairs
