// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/located_feature_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "surefoot/stairs/edges/edge_place.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kNear_m = 0.3;  ///< largest distance of a match; doors are farther apart

double square(double value) {
    return value * value;
}

/// Moves `pose` by `share` towards the observation. An observation from the other side replaces
/// `pose`.
void move(const FeaturePose& observation, double share, FeaturePose& pose) {
    const double turn_rad =
        std::remainder(observation.yaw_rad - pose.yaw_rad, 2.0 * std::numbers::pi);
    if (std::abs(turn_rad) > 0.5 * std::numbers::pi) {
        pose = observation;
        return;
    }
    pose.p_m += share * (observation.p_m - pose.p_m);
    pose.yaw_rad = std::remainder(pose.yaw_rad + share * turn_rad, 2.0 * std::numbers::pi);
}

double across_m(const FeaturePose& observation, const FeaturePose& pose) {
    const Vector2d way(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad));
    return way.dot((observation.p_m - pose.p_m).head<2>());
}

void take_mean(const Door& observation,
               double most,
               ObservationWeight& width,
               ObservationWeight& sill,
               Door& mean) {
    const double wider_m = observation.width_m - mean.width_m;
    const double share = width.take(square(observation.width_sigma_m), wider_m, most);
    const double higher_m = observation.sill_m - mean.sill_m;
    const double sill_m =
        mean.sill_m + sill.take(square(observation.sill_sigma_m), higher_m, most) * higher_m;
    const double width_m = mean.width_m + share * wider_m;
    const double clearance_m =
        std::isfinite(observation.clearance_m) ? observation.clearance_m : mean.clearance_m;
    FeaturePose pose = mean.pose;
    move(observation.pose, share, pose);
    mean = observation;
    mean.pose = pose;
    mean.width_m = width_m;
    mean.sill_m = sill_m;
    mean.clearance_m = clearance_m;
}
void write_sigmas(const ObservationWeight& width, const ObservationWeight& sill, Door& mean) {
    mean.width_sigma_m = width.sigma();
    mean.sill_sigma_m = sill.sigma();
}
/// The direction through a door drifts with the machine, its width does not.
void let_drift(const Drift&, double, ObservationWeight&, const Door&) {}

void take_mean(const LineFeature& observation,
               double most,
               ObservationWeight& across,
               ObservationWeight& height,
               LineFeature& mean) {
    const double share = across.take(
        square(observation.across_sigma_m), across_m(observation.pose, mean.pose), most);
    const double higher_m = observation.height_m - mean.height_m;
    const double height_m =
        mean.height_m + height.take(square(observation.sigma_m), higher_m, most) * higher_m;
    FeaturePose pose = mean.pose;
    move(observation.pose, share, pose);
    mean = observation;
    mean.pose = pose;
    mean.height_m = height_m;
}
void write_sigmas(const ObservationWeight& across,
                  const ObservationWeight& height,
                  LineFeature& mean) {
    mean.across_sigma_m = across.sigma();
    mean.sigma_m = height.sigma();
}
void let_drift(const Drift& drift, double away_m, ObservationWeight& across, const LineFeature&) {
    across.drift(drift.place_var_m2(away_m));
}

double distance_m(const FeaturePose& pose, const Vector2d& point_m) {
    const double away_m = (pose.p_m.head<2>() - point_m).norm();
    return std::isfinite(away_m) ? away_m : std::numeric_limits<double>::max();
}

}  // namespace

template <typename Place>
auto LocatedFeatureTracker<Place>::nearest(const Place& seen) -> Track* {
    Track* best = nullptr;
    double least_m = kNear_m;
    for (Track& track : tracks_) {
        const double away_m = (track.place.pose.p_m - seen.pose.p_m).template head<2>().norm();
        if (track.place.tracked.seen_now || !(away_m < least_m)) continue;
        least_m = away_m;
        best = &track;
    }
    return best;
}

template <typename Place>
void LocatedFeatureTracker<Place>::take(const Place& seen,
                                        std::int64_t time_ns,
                                        Track& track) const {
    const Tracked before = track.place.tracked;
    take_mean(seen, config_.mean_observations, track.across, track.height, track.place);
    write_sigmas(track.across, track.height, track.place);
    track.place.tracked = {.id = before.id,
                           .observations = before.observations + 1,
                           .last_seen_ns = time_ns,
                           .seen_now = true};
    track.shown = track.shown || track.place.tracked.observations >= 2;
    track.place_seen = 0;
}

template <typename Place>
void LocatedFeatureTracker<Place>::update(std::span<const Place> seen,
                                          const Terrain& terrain,
                                          std::int64_t time_ns,
                                          const Drift& drift,
                                          bool first,
                                          IdCounter& ids) {
    constexpr double kFarthest_m = 100.0;
    for (Track& track : tracks_) {
        const double away_m = std::min(kFarthest_m, distance_m(track.place.pose, terrain.stance_m));
        let_drift(drift, away_m, track.across, track.place);
        write_sigmas(track.across, track.height, track.place);
        track.place.tracked.seen_now = false;
    }
    for (const Place& observation : seen) {
        if (!observation.pose.p_m.allFinite()) continue;
        Track* track = nearest(observation);
        if (track == nullptr) {
            tracks_.emplace_back();
            track = &tracks_.back();
            track->place = observation;
            track->place.tracked = {.id = ids.next(), .observations = 0};
            track->shown = first;
        }
        take(observation, time_ns, *track);
    }
    std::erase_if(tracks_, [&](Track& track) {
        const Eigen::Vector3d& p_m = track.place.pose.p_m;
        if (track.place.tracked.seen_now) return false;
        if (!terrain.geometry.cell_at(p_m.x(), p_m.y())) return true;
        if (is_observed(terrain, p_m)) ++track.place_seen;
        return track.place_seen >=
               (track.shown ? config_.missed_observations : config_.first_observations);
    });
}

template <typename Place>
void LocatedFeatureTracker<Place>::write(const Vector2d& stance_m, std::vector<Place>& out) {
    out.clear();
    for (const Track& track : tracks_)
        if (track.shown) out.push_back(track.place);
    std::sort(out.begin(), out.end(), [&](const Place& a, const Place& b) {
        const double a_m = distance_m(a.pose, stance_m);
        const double b_m = distance_m(b.pose, stance_m);
        return a_m != b_m ? a_m < b_m : a.tracked.id < b.tracked.id;
    });
}

template class LocatedFeatureTracker<Door>;
template class LocatedFeatureTracker<LineFeature>;

}  // namespace surefoot::stairs
