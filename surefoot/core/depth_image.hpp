// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/views.hpp"

namespace surefoot {

/// Largest outlier probability of a trusted pixel. Chosen on the images to which the probability is
/// fitted: at least 85 % of the matches that are right within 1 px are trusted, and at most 1 % of
/// the trusted ones are wrong by more than 2 px (docs/lab/matching.md).
inline constexpr float kTrustedOutlierProbability = 0.2F;

/// Result of a stereo matcher for every pixel of the rectified left image.
struct DepthImage {
    Image<float> disparity_px;  ///< disparity, above 0; NaN = no match
    Image<float> sigma_px;      ///< one sigma of the disparity of a correct match; NaN = no match
    Image<float> outlier_probability;  ///< probability that the match is wrong, [0, 1]

    void resize(int width, int height) {
        disparity_px.resize(width, height);
        sigma_px.resize(width, height);
        outlier_probability.resize(width, height);
    }
};

}  // namespace surefoot
