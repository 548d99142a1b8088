// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

/// Indices of two features that probably show the same corner.
struct FeatureMatch {
    int candidate = 0;
    int query = 0;
};

struct MatchConfig {
    int max_distance = 64;  ///< largest distance of a match; random descriptors have about 128
    /// Largest ratio of the best distance to the best distance elsewhere in the image. It holds in
    /// both images. A corner that occurs twice in an image is not unique.
    double ratio = 0.85;
    double elsewhere_px = 12.0;  ///< nearer features are not "elsewhere": they may show one corner
};

/// Matches features that are each other's best match, wherever they are in the image. Compares all
/// pairs. The result depends on the order of the features only where distances are equal.
[[nodiscard]] std::vector<FeatureMatch> match_features(const MatchConfig& config,
                                                       std::span<const Feature> candidate,
                                                       std::span<const Feature> query);

}  // namespace surefoot::place_recognition
