// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place_memory.hpp"

#include <algorithm>
#include <utility>

#include "surefoot/core/angles.hpp"

namespace surefoot::place_recognition {
namespace {

/// Result for one keyframe: the pose of the view in the map, and the comparison that supports it.
struct Opinion {
    int keyframe = 0;
    Pose T_map_query;
    Comparison comparison;
};

/// True if `a` is better than `b`. More inliers are better; a refused result is worse than any
/// accepted result.
bool better(const Opinion& a, const Opinion& b) {
    const bool a_good = a.comparison.refusal == Refusal::none;
    const bool b_good = b.comparison.refusal == Refusal::none;
    if (a_good != b_good) return a_good;
    return a.comparison.inliers > b.comparison.inliers;
}

}  // namespace

bool is_near(const Pose& a, const Pose& b, double limit_m, double limit_rad) {
    const Vector6 d = difference(a, b);
    return d.head<3>().norm() <= limit_m && d.tail<3>().norm() <= limit_rad;
}

void PlaceMemory::add(Keyframe keyframe) {
    index_.add(static_cast<int>(keyframes_.size()), keyframe.view.features);
    keyframes_.push_back(std::move(keyframe));
}

void PlaceMemory::move(int keyframe, const Pose& T_map_body) {
    keyframes_[static_cast<std::size_t>(keyframe)].T_map_body = T_map_body;
}

bool PlaceMemory::covers(const Pose& T_map_body, double near_m, double near_deg) const {
    return std::any_of(keyframes_.begin(), keyframes_.end(), [&](const Keyframe& keyframe) {
        return is_near(keyframe.T_map_body, T_map_body, near_m, near_deg * kRadPerDeg);
    });
}

std::vector<int> PlaceMemory::likeliest(const View& view, int end) const {
    std::vector<int> chosen;
    for (const Candidate& candidate : index_.find(view.features, end)) {
        const Pose& T_map_body =
            keyframes_[static_cast<std::size_t>(candidate.keyframe)].T_map_body;
        const bool known = std::any_of(chosen.begin(), chosen.end(), [&](int other) {
            return is_near(keyframes_[static_cast<std::size_t>(other)].T_map_body,
                           T_map_body,
                           config_.near_m,
                           config_.near_deg * kRadPerDeg);
        });
        if (known) continue;
        chosen.push_back(candidate.keyframe);
        if (chosen.size() == static_cast<std::size_t>(config_.candidates)) break;
    }
    return chosen;
}

Answer PlaceMemory::recognise(const View& view, const Eigen::Vector3d& up_body, int end) const {
    Answer answer;
    answer.refusal = Refusal::few_features;
    if (view.features.size() < static_cast<std::size_t>(config_.min_features)) return answer;
    std::vector<Opinion> opinions;
    for (const int number : likeliest(view, end)) {
        const Keyframe& keyframe = keyframes_[static_cast<std::size_t>(number)];
        const Eigen::Vector3d up_keyframe =
            keyframe.T_map_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        Opinion opinion{
            number, {}, compare(config_.comparison, keyframe.view, up_keyframe, view, up_body)};
        opinion.T_map_query = keyframe.T_map_body * opinion.comparison.T_candidate_query;
        opinions.push_back(std::move(opinion));
    }
    answer.refusal = Refusal::no_candidate;
    if (opinions.empty()) return answer;
    const Opinion& best = *std::min_element(opinions.begin(), opinions.end(), better);
    answer.keyframe = best.keyframe;
    answer.comparison = best.comparison;
    answer.refusal = best.comparison.refusal;
    if (answer.refusal != Refusal::none) return answer;
    for (const Opinion& other : opinions) {
        // A result near the best pose names the same place. A result without inliers is no rival.
        if (is_near(
                best.T_map_query, other.T_map_query, config_.same_m, config_.same_deg * kRadPerDeg))
            continue;
        answer.rival = std::max(answer.rival,
                                static_cast<double>(other.comparison.inliers) /
                                    static_cast<double>(best.comparison.inliers));
    }
    if (answer.rival > config_.max_rival) answer.refusal = Refusal::ambiguous;
    return answer;
}

}  // namespace surefoot::place_recognition
