// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/pose.hpp"
#include "surefoot/place_recognition/feature_matching.hpp"
#include "surefoot/place_recognition/place.hpp"
#include "surefoot/place_recognition/refusal.hpp"

namespace surefoot::place_recognition {

struct ComparisonConfig {
    MatchConfig matching;
    int min_matches = 15;
    int min_inliers = 25;   ///< after the pose has said where to look
    double sigma_px = 1.0;  ///< of a corner found again; corners of higher levels are coarse
    int ransac_rounds = 300;
    double ransac_threshold_px = 4.0;
    // Where the pose is known, every feature says yes or no.
    double search_px = 6.0;     ///< how far from where it should be a corner may be found
    double disparity_px = 1.5;  ///< how far off its disparity may be
    int max_distance = 72;      ///< of its descriptor
    double min_scale = 0.6;     ///< seen from nearer or farther than this it is not asked
    int part_columns = 4;       ///< parts of the image that are asked one by one
    int part_rows = 3;
    int min_asked = 8;               ///< features of a part that can say anything
    double min_agreeing = 0.25;      ///< share of a part's features, below which it says no
    double min_agreeing_all = 0.35;  ///< the same of all features asked
    double max_parts_against = 0.2;  ///< share of the parts asked that may say no
    // Features off the level surface on which most agree (the floor) must agree on their own.
    int min_asked_off_floor = 15;          ///< fewer cannot say yes
    double min_agreeing_off_floor = 0.15;  ///< share of them; where the floor has moved: hardly any
    double level_m = 0.01;                 ///< beside disparity_px: how uneven a floor may be
    int min_parts = 5;                     ///< parts that hold an inlier
    double max_sigma_m = 0.05;             ///< of the position
    double max_sigma_deg = 1.5;
    double max_tilt_deg = 3.0;  ///< between up here and there
};

/// What a keyframe and a view say about each other.
struct Comparison {
    Refusal refusal = Refusal::few_matches;
    Pose T_candidate_query;                ///< base_link of the view in that of the keyframe
    Matrix6 covariance = Matrix6::Zero();  ///< of it; valid where the refusal is none
    int matches = 0;
    int inliers = 0;
    double tilt_deg = 0.0;
    int asked = 0;               ///< features of both views that should be seen in the other
    int agreeing = 0;            ///< of these, those that are
    int parts = 0;               ///< parts of the image where enough were asked
    int parts_against = 0;       ///< of these, those where too few agree
    int asked_off_floor = 0;     ///< features asked that do not lie on the floor
    int agreeing_off_floor = 0;  ///< of these, those that agree
    [[nodiscard]] double agreeing_share() const noexcept {
        return asked > 0 ? static_cast<double>(agreeing) / asked : 0.0;
    }
};

/// Where a view was taken from as seen by a keyframe, and whether that may be believed: matches of
/// descriptors, pose by consensus, then every feature of either view is looked for where the other
/// should show it. Look-alikes are told by that: a door that stands in every corridor agrees, the
/// floor before it says no. A floor alone proves nothing: printed and woven patterns repeat, so
/// that what stands on it must agree by itself where the floor says it is. `up_candidate`,
/// `up_query`: unit vectors in base_link of each.
///
/// Limit: a place that is a true twin, floor included, cannot be told by one view, nor one whose
/// floor lies a few centimetres beside where it lay in the other.
[[nodiscard]] Comparison compare(const ComparisonConfig& config,
                                 const View& candidate,
                                 const Eigen::Vector3d& up_candidate,
                                 const View& query,
                                 const Eigen::Vector3d& up_query);

}  // namespace surefoot::place_recognition
