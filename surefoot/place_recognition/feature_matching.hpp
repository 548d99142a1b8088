// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

/// Two features that look like one corner, by their numbers.
struct FeatureMatch {
    int candidate = 0;
    int query = 0;
};

struct MatchConfig {
    int max_distance = 64;  ///< of two descriptors of one corner; half of what chance gives
    /// The best must have at most this share of the distance of the best one elsewhere in the
    /// image, in both images: what is there twice tells nothing.
    double ratio = 0.85;
    double elsewhere_px = 12.0;  ///< nearer features may be the same corner once more
};

/// Features that are each other's best, without regard to where they are. Every pair is compared;
/// the result depends on the order of the features only where distances are equal.
[[nodiscard]] std::vector<FeatureMatch> match_features(const MatchConfig& config,
                                                       std::span<const Feature> candidate,
                                                       std::span<const Feature> query);

}  // namespace surefoot::place_recognition
