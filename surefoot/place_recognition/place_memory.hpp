// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/place_recognition/candidate_index.hpp"
#include "surefoot/place_recognition/view_comparison.hpp"

namespace surefoot::place_recognition {

struct MemoryConfig {
    ComparisonConfig comparison;
    int min_features = 60;
    int candidates = 5;  ///< keyframes that are compared, which takes nearly all of a query's time
    /// Keyframes near one that is compared already tell nothing new.
    double near_m = 0.4;
    double near_deg = 20.0;
    /// Two answers this far apart are two places.
    double same_m = 0.3;
    double same_deg = 6.0;
    /// Another place with more than this share of the inliers of the best explains the view too.
    double max_rival = 0.5;
};

/// One view, looked for among all keyframes.
struct Answer {
    Refusal refusal = Refusal::no_candidate;
    int keyframe = -1;  ///< the one that explains the view best, whether or not it is believed
    Comparison comparison;
    double rival = 0.0;  ///< inliers of the best other place over those of the best
};

/// Keyframes with an index over their descriptors.
class PlaceMemory {
  public:
    explicit PlaceMemory(const MemoryConfig& config = {}) : config_(config) {}

    void add(Keyframe keyframe);
    /// The pose graph has found out more about where a keyframe was.
    void move(int keyframe, const Pose& T_map_body);
    /// Is a view from there within the reach of a keyframe that is remembered?
    [[nodiscard]] bool covers(const Pose& T_map_body, double near_m, double near_deg) const;
    [[nodiscard]] const std::vector<Keyframe>& keyframes() const noexcept { return keyframes_; }

    /// Compares a view with the likeliest keyframes below number `end`. `up_body`: unit vector
    /// against gravity in base_link of the view. A pure function of view and memory.
    [[nodiscard]] Answer recognise(const View& view, const Eigen::Vector3d& up_body, int end) const;

  private:
    [[nodiscard]] std::vector<int> likeliest(const View& view, int end) const;

    MemoryConfig config_;
    std::vector<Keyframe> keyframes_;
    CandidateIndex index_;
};

/// Distance [m] and angle [rad] between two poses are both within limits.
[[nodiscard]] bool is_near(const Pose& a, const Pose& b, double limit_m, double limit_rad);

}  // namespace surefoot::place_recognition
