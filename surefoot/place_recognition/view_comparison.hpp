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
    int min_inliers = 25;   ///< inliers after the search at the known pose
    double sigma_px = 1.0;  ///< sigma of a matched corner; higher pyramid levels are coarse
    int ransac_rounds = 300;
    double ransac_threshold_px = 4.0;
    // Settings of the check at the known pose, which searches each feature in the other view.
    double search_px = 6.0;     ///< largest distance of a corner from its expected position
    double disparity_px = 1.5;  ///< largest error of the corner's disparity
    int max_distance = 72;      ///< largest distance of the corner's descriptor
    double min_scale = 0.6;     ///< features whose distance changes more are not checked
    int part_columns = 4;       ///< parts of the image that are checked separately
    int part_rows = 3;
    int min_asked = 8;               ///< smallest number of checked features in a part that counts
    double min_agreeing = 0.25;      ///< smallest agreeing share of a part that does not contradict
    double min_agreeing_all = 0.35;  ///< smallest agreeing share of all checked features
    double max_parts_against = 0.2;  ///< largest share of parts that may contradict
    // Features off the level surface on which most features agree (the floor) must agree too.
    int min_asked_off_floor = 15;          ///< smallest number of these features
    double min_agreeing_off_floor = 0.15;  ///< smallest agreeing share of these features
    double level_m = 0.01;      ///< unevenness of a floor [m], beyond the error of disparity_px
    int min_parts = 5;          ///< least number of parts with an inlier
    double max_sigma_m = 0.05;  ///< largest sigma of the position
    double max_sigma_deg = 1.5;
    double max_tilt_deg = 3.0;  ///< largest angle between the up directions of both views
};

/// Result of comparing a keyframe (candidate) with a view (query).
struct Comparison {
    Refusal refusal = Refusal::few_matches;
    Pose T_candidate_query;  ///< pose of the query's base_link in that of the candidate
    Matrix6 covariance = Matrix6::Zero();  ///< for T_candidate_query; valid if refusal is none
    int matches = 0;
    int inliers = 0;
    double tilt_deg = 0.0;
    int asked = 0;               ///< checked features: each should be visible in the other view
    int agreeing = 0;            ///< number of checked features that were found
    int parts = 0;               ///< parts of the image with enough checked features
    int parts_against = 0;       ///< number of these parts with too few agreeing features
    int asked_off_floor = 0;     ///< checked features that do not lie on the floor
    int agreeing_off_floor = 0;  ///< number of these features that agree
    [[nodiscard]] double agreeing_share() const noexcept {
        return asked > 0 ? static_cast<double>(agreeing) / asked : 0.0;
    }
};

/// Computes the pose of a view relative to a keyframe and whether it is credible. Steps: match
/// descriptors, find the pose by consensus, then project the features of each view into the
/// other view and search them there. This rejects look-alikes: a door that exists in every corridor
/// agrees, but the floor before it does not. A floor alone proves nothing, because printed and
/// woven patterns repeat: objects on the floor must agree as well. `up_candidate`, `up_query`: unit
/// vectors in each view's base_link.
///
/// Limit: one view cannot distinguish a place from an exact copy, if the copy includes the floor.
/// The floor pattern of the copy may even be displaced by a few centimetres.
[[nodiscard]] Comparison compare(const ComparisonConfig& config,
                                 const View& candidate,
                                 const Eigen::Vector3d& up_candidate,
                                 const View& query,
                                 const Eigen::Vector3d& up_query);

}  // namespace surefoot::place_recognition
