// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/angles.hpp"

namespace surefoot::place_recognition {
namespace {

/// Sigmas of the motion while odometry is lost. This motion is a guess and must not constrain the
/// pose graph.
constexpr double kLostSigma_m = 2.0;
constexpr double kLostSigma_rad = 1.0;

void add_sigmas(Matrix6& covariance, double sigma_m, double sigma_rad) {
    covariance.diagonal().head<3>().array() += sigma_m * sigma_m;
    covariance.diagonal().tail<3>().array() += sigma_rad * sigma_rad;
}

}  // namespace

PlaceTracker::PlaceTracker(const TrackerConfig& config, Place saved)
    : config_(config),
      memory_(config.memory),
      saved_(static_cast<int>(saved.keyframes.size())),
      located_(saved.keyframes.empty()) {
    for (Keyframe& keyframe : saved.keyframes) memory_.add(std::move(keyframe));
    if (located_) graph_.hold_first();
}

void PlaceTracker::follow(const MotionEstimate& motion) {
    if (graph_.nodes() > 0) {
        covariance_ =
            compose_covariance(covariance_, motion.T_previous_body, motion.relative_covariance);
        T_keyframe_body_ = T_odom_keyframe_.inverse() * motion.T_odom_body;
    }
    lost_ = lost_ || motion.health == Health::lost;
    last_ = motion;
}

bool PlaceTracker::is_due() const {
    if (last_.health == Health::lost) return false;
    if (graph_.nodes() == 0) return true;
    return !is_near(
        Pose{}, T_keyframe_body_, config_.keyframe_m, config_.keyframe_deg * kRadPerDeg);
}

void PlaceTracker::forget_pending() {
    pending_.clear();
    committed_ = 0;
}

void PlaceTracker::add_node() {
    if (lost_) {
        add_sigmas(covariance_, kLostSigma_m, kLostSigma_rad);
        forget_pending();  // T_map_odom may differ from that of the earlier recognitions
    }
    if (graph_.nodes() == 0)
        graph_.add_first(last_.T_odom_body);
    else
        graph_.add_next(T_keyframe_body_, covariance_);
    lost_ = false;
    T_odom_keyframe_ = last_.T_odom_body;
    T_keyframe_body_ = Pose{};
    covariance_.setZero();
}

int PlaceTracker::keyframes_to_ask() const {
    if (!located_) return saved_;
    const auto recent = [&](const Own& own) {
        return own.node > graph_.nodes() - 1 - config_.recent_keyframes;
    };
    return saved_ + static_cast<int>(std::count_if(
                        own_.begin(), own_.end(), [&](const Own& own) { return !recent(own); }));
}

int PlaceTracker::node_of(int keyframe) const {
    return own_[static_cast<std::size_t>(keyframe - saved_)].node;
}

std::optional<Sighting> PlaceTracker::see(const camera::RectifiedRig& rig,
                                          ImageView<const std::uint8_t> left,
                                          const DepthImage& depth) {
    if (!is_due()) return std::nullopt;
    add_node();
    const int node = graph_.nodes() - 1;
    View view{last_.time_ns, rig, describe(config_.describe, left, depth)};
    Sighting sighting = look_for(view, node);
    remember(std::move(view), node);
    sightings_.push_back(sighting);
    return sighting;
}

Sighting PlaceTracker::look_for(const View& view, int node) {
    const Eigen::Vector3d up_body =
        last_.T_odom_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const Answer answer = memory_.recognise(view, up_body, keyframes_to_ask());
    Sighting sighting{view.time_ns,
                      answer.refusal,
                      answer.keyframe,
                      answer.keyframe >= 0 && answer.keyframe < saved_,
                      answer.comparison,
                      std::nullopt};
    if (answer.refusal == Refusal::none) {
        sighting.refusal = confirm(answer, node);
        misses_ = 0;
    } else if (++misses_ > config_.max_misses) {
        forget_pending();
    }
    if (sighting.refusal == Refusal::none) sighting.T_map_odom = T_map_odom();
    return sighting;
}

Refusal PlaceTracker::confirm(const Answer& answer, int node) {
    const Keyframe& keyframe = memory_.keyframes()[static_cast<std::size_t>(answer.keyframe)];
    Pending now{node,
                answer.keyframe,
                answer.comparison.T_candidate_query,
                answer.comparison.covariance,
                {}};
    add_sigmas(now.covariance, config_.extra_sigma_m, config_.extra_sigma_deg * kRadPerDeg);
    now.T_map_odom = keyframe.T_map_body * now.T_keyframe_node * last_.T_odom_body.inverse();
    // Compares the poses at the machine's position. At the origin of odom, which may be far away, a
    // rotation would look like a translation.
    const auto agrees = [&](const Pending& other) {
        return is_near(other.T_map_odom * last_.T_odom_body,
                       now.T_map_odom * last_.T_odom_body,
                       config_.agree_m,
                       config_.agree_deg * kRadPerDeg);
    };
    if (!pending_.empty() && !agrees(pending_.back())) forget_pending();
    pending_.push_back(std::move(now));
    if (pending_.size() < static_cast<std::size_t>(config_.confirmations))
        return Refusal::unconfirmed;
    return commit() ? Refusal::none : Refusal::inconsistent;
}

int PlaceTracker::add_to_graph(const Pending& pending) {
    if (pending.keyframe >= saved_) {
        return graph_.recognise(
            node_of(pending.keyframe), pending.node, pending.T_keyframe_node, pending.covariance);
    }
    const Keyframe& keyframe = memory_.keyframes()[static_cast<std::size_t>(pending.keyframe)];
    return graph_.recognise_fixed(
        pending.node, keyframe.T_map_body * pending.T_keyframe_node, pending.covariance);
}

bool PlaceTracker::commit() {
    const PoseGraph before = graph_;
    if (!located_) {
        graph_.place(pending_.back().node, pending_.back().T_map_odom * last_.T_odom_body);
    }
    int first = -1;
    int last = -1;
    for (std::size_t i = committed_; i < pending_.size(); ++i) {
        last = add_to_graph(pending_[i]);
        if (first < 0) first = last;
    }
    bool good = graph_.solve();
    for (int i = first; i <= last; ++i) good = good && graph_.chi2(i) <= config_.max_chi2;
    if (!good) {
        graph_ = before;
        forget_pending();
        return false;
    }
    committed_ = pending_.size();
    located_ = true;
    for (const Own& own : own_) memory_.move(own.keyframe, graph_.T_map_body(own.node));
    return true;
}

void PlaceTracker::remember(View view, int node) {
    if (memory_.keyframes().size() >= static_cast<std::size_t>(kMostKeyframes)) return;
    const Pose& T_map_body = graph_.T_map_body(node);
    // For a known place, only new views are worth the memory.
    if (located_ && memory_.covers(T_map_body, config_.keyframe_m, config_.keyframe_deg)) return;
    own_.push_back({static_cast<int>(memory_.keyframes().size()), node});
    memory_.add({std::move(view), T_map_body});
}

std::optional<Pose> PlaceTracker::T_map_odom() const {
    if (!located_) return std::nullopt;
    // Returns exactly the identity, because no recognition has corrected a pose.
    if (graph_.recognitions() == 0) return Pose{};
    return graph_.T_map_body(graph_.nodes() - 1) * T_odom_keyframe_.inverse();
}

Place PlaceTracker::place() const {
    Place place;
    const auto& all = memory_.keyframes();
    place.keyframes.assign(all.begin(), all.begin() + saved_);
    if (!located_) return place;
    for (const Own& own : own_) {
        const Keyframe& keyframe = all[static_cast<std::size_t>(own.keyframe)];
        const bool known =
            std::any_of(place.keyframes.begin(), place.keyframes.end(), [&](const Keyframe& other) {
                return is_near(other.T_map_body,
                               keyframe.T_map_body,
                               0.8 * config_.keyframe_m,
                               0.8 * config_.keyframe_deg * kRadPerDeg);
            });
        if (!known) place.keyframes.push_back(keyframe);
    }
    return place;
}

}  // namespace surefoot::place_recognition
