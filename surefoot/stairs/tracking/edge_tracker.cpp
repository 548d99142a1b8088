// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/edge_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "surefoot/core/angles.hpp"
#include "surefoot/stairs/edges/edge_place.hpp"
#include "surefoot/stairs/edges/edge_relations.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kGate_sigma = 3.4;
/// Lower limits of the match gates, because a distant observation is off by more than its sigma.
/// They are half of the shortest going and half of the lowest riser, so the next step does not
/// match unless the sigmas are large.
constexpr double kAcross_m = 0.075;
constexpr double kHeight_m = 0.04;
constexpr double kAngle_rad = 20.0 * kRadPerDeg;
/// Upper limits of the match gates. Edges farther apart never match, however large the drift may
/// be.
constexpr double kMaxAcross_m = 0.25;
constexpr double kMaxHeight_m = 0.08;
constexpr double kMaxAngle_rad = 40.0 * kRadPerDeg;
constexpr double kMinOverlap = 0.3;  ///< smallest overlap, as a share of the shorter edge
constexpr double kPieceAcross_m = 0.03;
/// An unmatched edge this close to a matched edge is the same edge. Two edges of one upper ground
/// that fall in one direction are never so close.
constexpr double kDouble_m = 0.2;
constexpr double kCovered = 0.7;
/// The ends of an edge move by this much between observations, because of cells and occluded
/// regions.
constexpr double kEnds_m = 0.1;
constexpr double kFarthest_m = 100.0;  ///< beyond every map; used if there is no stance

double angle_between(const Edge& a, const Edge& b) {
    const Vector2d u = a.along();
    const Vector2d v = b.along();
    return std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v));
}

double gate(double sigma, double floor, double ceiling) {
    return std::clamp(kGate_sigma * sigma, floor, ceiling);
}

/// Returns the middle of the part that two edges share, on the second edge.
Vector2d shared_middle_m(const Edge& a, const Edge& b) {
    const Vector2d along = b.along();
    const double from_m = (a.from_m - b.from_m).dot(along);
    const double to_m = (a.to_m - b.from_m).dot(along);
    const double first_m = std::max(0.0, std::min(from_m, to_m));
    const double last_m = std::min(b.length_m(), std::max(from_m, to_m));
    return b.from_m + 0.5 * (first_m + last_m) * along;
}

/// Returns the smallest possible height difference of the lower grounds. Lower ground that was not
/// seen lies at `lower_m` or lower.
double lower_difference_m(const Edge& a, const Edge& b) {
    const double difference_m = b.lower_m - a.lower_m;
    if (a.lower_seen && b.lower_seen) return std::abs(difference_m);
    if (a.lower_seen)
        return std::max(0.0, -difference_m);  // the lower ground of b lies at `lower_m` or lower
    if (b.lower_seen) return std::max(0.0, difference_m);
    return 0.0;
}

/// Returns the disagreement of two edges: the sum of (difference / gate)^2 for the position across
/// the edge, the two heights and the direction. Empty if they cannot be the same edge.
std::optional<double> cost_of(const EdgeTrack& track, const Edge& seen) {
    const Edge& edge = track.edge;
    if (std::abs(seen.upper_m - edge.upper_m) > kMaxHeight_m)
        return std::nullopt;  // rejects most pairs early
    const double level_sigma_m = std::hypot(track.level.sigma(), seen.height_sigma_m);
    const double height_gate_m = gate(level_sigma_m, kHeight_m, kMaxHeight_m);
    const double upper_m = std::abs(seen.upper_m - edge.upper_m);
    if (!(upper_m <= height_gate_m)) return std::nullopt;
    const double lower_m = lower_difference_m(edge, seen);
    if (!(lower_m <= height_gate_m)) return std::nullopt;
    const double angle_gate_rad =
        gate(std::hypot(track.angle.sigma(), seen.angle_sigma_rad), kAngle_rad, kMaxAngle_rad);
    const double angle_rad = std::abs(angle_between(edge, seen));
    if (!(angle_rad <= angle_gate_rad)) return std::nullopt;
    const double shorter_m = std::min(edge.length_m(), seen.length_m());
    if (!(overlap_m(edge, seen) >= kMinOverlap * shorter_m)) return std::nullopt;
    const double across_gate_m =
        gate(std::hypot(track.across.sigma(), seen.across_sigma_m), kAcross_m, kMaxAcross_m);
    const double across_m = std::abs(edge.below_m(shared_middle_m(edge, seen)));
    if (!(across_m <= across_gate_m)) return std::nullopt;
    const auto square = [](double value) { return value * value; };
    return square(across_m / across_gate_m) + square(upper_m / height_gate_m) +
           square(lower_m / height_gate_m) + square(angle_rad / angle_gate_rad);
}

double distance_m(const Edge& edge, const Vector2d& point_m) {
    const double t_m = std::clamp((point_m - edge.from_m).dot(edge.along()), 0.0, edge.length_m());
    const double away_m = (edge.from_m + t_m * edge.along() - point_m).norm();
    return std::isfinite(away_m) ? away_m : std::numeric_limits<double>::max();
}

/// Lets the upper ground extend beyond the observation by at most one sigma.
void hold_back(const Edge& seen, Edge& edge) {
    const double beyond_m = std::max(-edge.below_m(seen.from_m), -edge.below_m(seen.to_m));
    const double back_m = std::max(0.0, beyond_m - seen.across_sigma_m);
    const Vector2d shift_m = -back_m * edge.down();
    edge.from_m += shift_m;
    edge.to_m += shift_m;
}

void grow(const Edge& piece, Edge& edge) {
    const Vector2d along = edge.along();
    const double before_m = std::min(0.0, (piece.from_m - edge.from_m).dot(along));
    const double behind_m = std::max(0.0, (piece.to_m - edge.to_m).dot(along));
    edge.from_m += before_m * along;
    edge.to_m += behind_m * along;
}

void write_sigmas(EdgeTrack& track) {
    track.edge.across_sigma_m = track.across.sigma();
    track.edge.angle_sigma_rad = track.angle.sigma();
    track.edge.height_sigma_m = track.height.sigma();
}

/// A drop stays a drop. A kerb needs two observations. It ends after `missed_observations`
/// consecutive observations that find the edge but no kerb.
void name(const ObservedEdge& seen, const TrackingConfig& config, EdgeTrack& track) {
    track.drop = track.drop || seen.drop;
    if (seen.kerb) {
        ++track.kerb_observations;
        track.kerb_missed = 0;
        track.kerb_down = seen.kerb_down;
    } else if (++track.kerb_missed >= config.missed_observations) {
        track.kerb_observations = 0;
        track.kerb = false;
    }
    track.kerb = track.kerb || track.kerb_observations >= 2;
}

void take_height(const Edge& observation,
                 double old_height_m,
                 double most_observations,
                 EdgeTrack& track) {
    Edge& edge = track.edge;
    double height_m = old_height_m;
    const double var_m2 = observation.height_sigma_m * observation.height_sigma_m;
    if (observation.lower_seen && !edge.lower_seen)
        track.height = {};  // only a bound was known so far
    if (observation.lower_seen) {
        const double higher_m = observation.height_m() - old_height_m;
        height_m += higher_m * track.height.take(var_m2, higher_m, most_observations);
        edge.lower_seen = true;
    } else if (!edge.lower_seen) {  // the lower of two bounds is valid
        height_m = std::max(height_m, observation.height_m());
        (void)track.height.take(var_m2, 0.0, most_observations);
    }
    edge.lower_m = edge.upper_m - height_m;
}

}  // namespace

const EdgeTrack* EdgeTracker::find(std::uint32_t id) const {
    for (const EdgeTrack& track : tracks_)
        if (track.edge.tracked.id == id) return &track;
    return nullptr;
}

void EdgeTracker::update(std::span<const ObservedEdge> seen,
                         const Terrain& terrain,
                         std::int64_t time_ns,
                         const Drift& drift,
                         bool first,
                         IdCounter& ids) {
    age(drift, terrain.stance_m);
    pair_up(seen);
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (track_of_seen_[i] >= 0)
            take(seen[i], terrain, time_ns, tracks_[static_cast<std::size_t>(track_of_seen_[i])]);
    take_pieces(seen);
    for (EdgeTrack& track : tracks_)
        if (!track.edge.tracked.seen_now) miss(terrain, track);
    remove(terrain);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (id_of_seen_[i] != 0) continue;
        id_of_seen_[i] = begin(seen[i], terrain, time_ns, first, ids);
    }
    std::sort(tracks_.begin(), tracks_.end(), [](const EdgeTrack& a, const EdgeTrack& b) {
        if (a.away_m != b.away_m) return a.away_m < b.away_m;
        return a.edge.tracked.id < b.edge.tracked.id;
    });
}

void EdgeTracker::age(const Drift& drift, const Vector2d& stance_m) {
    for (EdgeTrack& track : tracks_) {
        track.away_m = distance_m(track.edge, stance_m);
        const double bounded_m = std::min(track.away_m, kFarthest_m);
        track.across.drift(drift.place_var_m2(bounded_m));
        track.angle.drift(drift.yaw_var_rad2);
        track.level.drift(drift.level_var_m2(bounded_m));
        track.edge.tracked.seen_now = false;
        write_sigmas(track);
    }
}

void EdgeTracker::pair_up(std::span<const ObservedEdge> seen) {
    pairs_.clear();
    for (std::size_t t = 0; t < tracks_.size(); ++t)
        for (std::size_t s = 0; s < seen.size(); ++s)
            if (const auto cost = cost_of(tracks_[t], seen[s].edge))
                pairs_.push_back({*cost, t, s});
    // Takes the pair with the lowest cost first, then the lowest of the rest. So each pair is the
    // best that is left for both of its edges.
    std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
        if (a.cost != b.cost) return a.cost < b.cost;
        return a.track != b.track ? a.track < b.track : a.seen < b.seen;
    });
    track_of_seen_.assign(seen.size(), -1);
    id_of_seen_.assign(seen.size(), 0);
    seen_of_track_.assign(tracks_.size(), -1);
    for (const Pair& pair : pairs_) {
        if (track_of_seen_[pair.seen] >= 0 || seen_of_track_[pair.track] >= 0) continue;
        track_of_seen_[pair.seen] = static_cast<int>(pair.track);
        seen_of_track_[pair.track] = static_cast<int>(pair.seen);
        id_of_seen_[pair.seen] = tracks_[pair.track].edge.tracked.id;
    }
}

/// One observation may split an edge into two pieces.
void EdgeTracker::take_pieces(std::span<const ObservedEdge> seen) {
    for (const Pair& pair : pairs_) {
        if (id_of_seen_[pair.seen] != 0) continue;
        const int other = seen_of_track_[pair.track];
        if (other < 0) continue;
        const Edge& piece = seen[pair.seen].edge;
        const Edge& taken = seen[static_cast<std::size_t>(other)].edge;
        EdgeTrack& track = tracks_[pair.track];
        const double shorter_m = std::min(piece.length_m(), taken.length_m());
        if (overlap_m(taken, piece) > kMinOverlap * shorter_m)
            continue;  // the piece is a parallel edge
        if (std::abs(track.edge.below_m(piece.middle_m())) > kPieceAcross_m) continue;
        grow(piece, track.edge);
        if (seen[pair.seen].drop) {
            track.drop = track.shown = true;
            hold_back(piece, track.edge);
        }
        id_of_seen_[pair.seen] = track.edge.tracked.id;
    }
}

void EdgeTracker::take(const ObservedEdge& seen,
                       const Terrain& terrain,
                       std::int64_t time_ns,
                       EdgeTrack& track) {
    const Edge& observation = seen.edge;
    Edge& edge = track.edge;
    const auto var = [](double sigma) { return sigma * sigma; };
    // The position is known best at the middle of the observation, independent of its angle.
    const Vector2d middle_m = observation.middle_m();
    const double off_m = edge.below_m(middle_m);
    const double turn_rad = angle_between(edge, observation);
    const double most = config_.mean_observations;
    const double share = track.across.take(var(observation.across_sigma_m), off_m, most);
    const double turned_rad =
        turn_rad * track.angle.take(var(observation.angle_sigma_rad), turn_rad, most);
    const Vector2d pivot_m = middle_m + (share - 1.0) * off_m * edge.down();
    const Eigen::Rotation2Dd turn(turned_rad);
    const Vector2d along = turn * edge.along();
    const double from_m = (edge.from_m - pivot_m).dot(edge.along());
    const double to_m = (edge.to_m - pivot_m).dot(edge.along());
    edge.from_m = pivot_m + from_m * along;
    edge.to_m = pivot_m + to_m * along;

    const double old_height_m = edge.height_m();
    const double rise_m = observation.upper_m - edge.upper_m;
    edge.upper_m += rise_m * track.level.take(0.5 * var(observation.height_sigma_m), rise_m, most);
    take_height(observation, old_height_m, most, track);
    edge.upper_depth_m = observation.upper_depth_m;
    edge.lower_depth_m = observation.lower_depth_m;
    edge.upper_walkable = observation.upper_walkable;
    edge.lower_walkable = observation.lower_walkable;
    edge.open = observation.open;
    // The likelihood ratio comes from the last observation that saw the lower ground.
    if (!std::isnan(observation.log_step_ratio)) edge.log_step_ratio = observation.log_step_ratio;
    edge.hidden = observation.hidden;
    name(seen, config_, track);
    take_ends(observation, terrain, track);
    if (track.drop) hold_back(observation, edge);
    write_sigmas(track);

    track.missed = track.place_known = track.level_observations = 0;
    edge.tracked.seen_now = true;
    edge.tracked.last_seen_ns = time_ns;
    ++edge.tracked.observations;
    track.shown = true;
}

/// An edge grows at once. A part beyond the observation's ends fades. Such a part of a drop fades
/// only if the ground there is level, or if the part is no longer than kEnds_m.
void EdgeTracker::take_ends(const Edge& observation,
                            const Terrain& terrain,
                            EdgeTrack& track) const {
    Edge& edge = track.edge;
    const Vector2d along = edge.along();
    const double first_m = (observation.from_m - edge.from_m).dot(along);
    const double last_m = (observation.to_m - edge.to_m).dot(along);
    const auto fades = [&](const Vector2d& from_m, const Vector2d& to_m) {
        if (!track.drop || (to_m - from_m).norm() <= kEnds_m) return true;
        Edge beyond = edge;
        beyond.from_m = from_m;
        beyond.to_m = to_m;
        return place_of(beyond, terrain) == PlaceOfEdge::level;
    };
    const Vector2d from_m = edge.from_m + first_m * along;
    const Vector2d to_m = edge.to_m + last_m * along;
    const double share = 1.0 / config_.mean_observations;
    const double move_from = first_m <= 0.0 ? 1.0 : (fades(edge.from_m, from_m) ? share : 0.0);
    const double move_to = last_m >= 0.0 ? 1.0 : (fades(to_m, edge.to_m) ? share : 0.0);
    edge.from_m += move_from * first_m * along;
    edge.to_m += move_to * last_m * along;
}

std::uint32_t EdgeTracker::begin(const ObservedEdge& seen,
                                 const Terrain& terrain,
                                 std::int64_t time_ns,
                                 bool first,
                                 IdCounter& ids) {
    const auto var = [](double sigma) { return sigma * sigma; };
    const Edge& observation = seen.edge;
    EdgeTrack track;
    track.edge = observation;
    (void)track.across.take(var(observation.across_sigma_m), 0.0, config_.mean_observations);
    (void)track.angle.take(var(observation.angle_sigma_rad), 0.0, config_.mean_observations);
    (void)track.level.take(0.5 * var(observation.height_sigma_m), 0.0, config_.mean_observations);
    (void)track.height.take(var(observation.height_sigma_m), 0.0, config_.mean_observations);
    track.away_m = distance_m(observation, terrain.stance_m);
    name(seen, config_, track);
    track.shown = first || track.drop;
    track.kerb = track.kerb || (first && seen.kerb);
    track.edge.tracked = {.id = 0, .observations = 1, .last_seen_ns = time_ns, .seen_now = true};
    if (tracks_.size() == kMaxEdges && !make_room_for(track)) return 0;
    track.edge.tracked.id = ids.next();
    tracks_.push_back(track);
    return track.edge.tracked.id;
}

/// Removes the least important edge if `track` is more important. Order: drops before others, seen
/// now before unseen, near before far.
bool EdgeTracker::make_room_for(const EdgeTrack& track) {
    const auto matters_less = [](const EdgeTrack& a, const EdgeTrack& b) {
        if (a.drop != b.drop) return b.drop;
        if (a.edge.tracked.seen_now != b.edge.tracked.seen_now) return b.edge.tracked.seen_now;
        return a.away_m > b.away_m;
    };
    const auto least = std::min_element(tracks_.begin(), tracks_.end(), matters_less);
    if (!matters_less(*least, track)) return false;
    *least = tracks_.back();
    tracks_.pop_back();
    return true;
}

/// True if the ground is one smooth slope, so that the edge is no drop. Returns false for an edge
/// with an uncertain position, because it may lie outside the examined ground.
bool EdgeTracker::is_seen_to_be_smooth(const Terrain& terrain, const Edge& edge) {
    constexpr double kReach_m = 0.35;  ///< depth of ground on either side
    constexpr double kSure_m = 0.05;
    if (edge.across_sigma_m > kSure_m) return false;
    const Vector2d middle_m = edge.middle_m();
    if (!is_observed(terrain, {middle_m.x(), middle_m.y(), edge.upper_m})) return false;
    const StepEvidence evidence = evidence_.weigh(terrain, edge, kReach_m, kReach_m);
    return !evidence.is_hidden && evidence.log_ratio < least_log_ratio_;
}

void EdgeTracker::miss(const Terrain& terrain, EdgeTrack& track) {
    ++track.missed;
    PlaceOfEdge place = place_of(track.edge, terrain);
    if (place == PlaceOfEdge::uneven && track.drop && is_seen_to_be_smooth(terrain, track.edge))
        place = PlaceOfEdge::level;
    if (place != PlaceOfEdge::unknown) ++track.place_known;
    track.level_observations = place == PlaceOfEdge::level ? track.level_observations + 1 : 0;
}

bool EdgeTracker::is_over(const Terrain& terrain, const EdgeTrack& track) const {
    if (!is_in_window(track.edge, terrain)) return true;
    if (track.level_observations >= config_.level_observations) return true;
    if (track.drop) return false;
    return track.place_known >=
           (track.shown ? config_.missed_observations : config_.first_observations);
}

/// True if observations find another edge just beside the tracked edge instead of it.
bool EdgeTracker::is_now_another(const EdgeTrack& track) {
    if (track.missed < config_.level_observations) return false;
    for (EdgeTrack& other : tracks_) {
        const Edge& edge = other.edge;
        if (!edge.tracked.seen_now) continue;
        if (std::abs(edge.upper_m - track.edge.upper_m) > kHeight_m ||
            std::abs(angle_between(edge, track.edge)) > kMaxAngle_rad ||
            overlap_m(track.edge, edge) < kCovered * track.edge.length_m() ||
            std::abs(edge.below_m(shared_middle_m(track.edge, edge))) > kDouble_m)
            continue;
        other.drop = other.drop || track.drop;
        other.shown = other.shown || track.shown;
        return true;
    }
    return false;
}

void EdgeTracker::remove(const Terrain& terrain) {
    for (std::size_t i = 0; i < tracks_.size();) {
        if (is_over(terrain, tracks_[i]) || is_now_another(tracks_[i])) {
            tracks_[i] = tracks_.back();
            tracks_.pop_back();
        } else {
            ++i;
        }
    }
}

}  // namespace surefoot::stairs
