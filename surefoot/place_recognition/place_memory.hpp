// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/place_recognition/candidate_index.hpp"
#include "surefoot/place_recognition/view_comparison.hpp"

namespace surefoot::place_recognition {

struct MemoryConfig {
    ComparisonConfig comparison;
    int min_features = 60;
    int candidates = 5;  ///< number of compared keyframes; they take nearly all of a query's time
    /// Keyframes within this distance and angle of a compared keyframe are not compared.
    double near_m = 0.4;
    double near_deg = 20.0;
    /// Two answers farther apart than this distance or angle count as two places.
    double same_m = 0.3;
    double same_deg = 6.0;
    /// A view is ambiguous if another place has more than this share of the best place's inliers.
    double max_rival = 0.5;
};

/// Result of comparing one view with the most similar keyframes.
struct Answer {
    Refusal refusal = Refusal::no_candidate;
    int keyframe = -1;  ///< keyframe that explains the view best, even if refused
    Comparison comparison;
    double rival = 0.0;  ///< inliers of the second best place divided by those of the best
};

/// Keyframes with an index of their descriptors.
class PlaceMemory {
  public:
    explicit PlaceMemory(const MemoryConfig& config = {}) : config_(config) {}

    void add(Keyframe keyframe);
    /// Replaces the pose of a keyframe by a better pose from the pose graph.
    void move(int keyframe, const Pose& T_map_body);
    /// Returns true if a stored keyframe lies within the given distance and angle of a pose.
    [[nodiscard]] bool covers(const Pose& T_map_body, double near_m, double near_deg) const;
    [[nodiscard]] const std::vector<Keyframe>& keyframes() const noexcept { return keyframes_; }

    /// Compares a view with the most similar keyframes below number `end`. `up_body`: unit vector
    /// against gravity in base_link of the view. The result depends only on view and memory.
    [[nodiscard]] Answer recognise(const View& view, const Eigen::Vector3d& up_body, int end) const;

  private:
    [[nodiscard]] std::vector<int> likeliest(const View& view, int end) const;

    MemoryConfig config_;
    std::vector<Keyframe> keyframes_;
    CandidateIndex index_;
};

/// True if the distance [m] and the angle [rad] between two poses are both within the limits.
[[nodiscard]] bool is_near(const Pose& a, const Pose& b, double limit_m, double limit_rad);

}  // namespace surefoot::place_recognition
