// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/scene_source.hpp"

/// Rectified stereo pairs with true disparities, and scores of matchers on them.
namespace surefoot::experiments {

/// A rectified pair and the true disparities of its left image.
struct TruePair {
    std::string name;
    GreyImage left;
    GreyImage right;
    Image<float> truth_px;  ///< disparity as published; NaN = unknown or excluded from scores
    int disparities = 64;   ///< search range: 0 to disparities - 1
    double step_px = 0.0;   ///< quantization of the stored truth; 0 = exact
    double truth_offset_px =
        0.0;  ///< added by Truth::centred; adirondack's truth is truncated to whole px
};

/// Reads the Middlebury pairs cones, teddy, cloth3, adirondack, and adirondack with a different
/// exposure of the right image, in this order. Only pixels that both cameras see keep their truth.
/// An error names the pair whose images are missing in `folder`.
[[nodiscard]] Result<std::vector<TruePair>> middlebury_pairs(const std::string& folder);

/// Renders the first frame of a scene. It contains the calibration error of the profile. Every
/// pixel on a surface has a truth; for glass and mirrors it is the disparity of the pane itself.
[[nodiscard]] Result<TruePair> simulated_pair(const sim::SceneOptions& options);

/// Sets the truth of pixels that the right camera does not see to NaN: pixels outside the right
/// image, and pixels occluded by a surface farther right.
void forget_hidden(TruePair& pair);

/// Fills each unknown pixel with the smaller of its nearest known neighbours in the row.
[[nodiscard]] Image<float> filled(const Image<float>& disparity_px);

/// Shares of the pixels with a truth [%].
struct Score {
    double bad_1 = 0.0;          ///< error above 1 px, after `filled`
    double bad_2 = 0.0;          ///< error above 2 px, after `filled`
    double matched_bad_1 = 0.0;  ///< error above 1 px, share of the matched pixels
    double matched_bad_2 = 0.0;  ///< error above 2 px, share of the matched pixels
    double density = 0.0;        ///< matched pixels
};

/// Truth to compare with: as published, or with TruePair::truth_offset_px added.
enum class Truth : std::uint8_t { as_published, centred };
inline constexpr const char* kTruthNames[] = {"as published", "centred"};

/// Scores disparities against a truth. The disparities are first rounded to OpenCV's steps of
/// 1/16 px, because with a truth in whole pixels half a step changes the score.
[[nodiscard]] Score score(const TruePair& pair, const Image<float>& disparity_px, Truth truth);

}  // namespace surefoot::experiments
