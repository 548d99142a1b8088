// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/scene_source.hpp"

/// Pairs of images whose disparities are known, and how far a matcher is from them.
namespace surefoot::experiments {

/// A rectified pair and its truth.
struct TruePair {
    std::string name;
    GreyImage left;
    GreyImage right;
    Image<float> truth_px;  ///< as published; NaN = unknown, or not to be judged
    int disparities = 64;   ///< to search, from 0 on
    double step_px = 0.0;   ///< in which the truth is stored; 0 = exact
    double truth_offset_px =
        0.0;  ///< to add: adirondack's truth is cut to whole pixels, not rounded
};

/// Middlebury's cones, teddy, cloth3, adirondack, and adirondack with a right eye that is exposed
/// differently, in this order; the truth is that of pixels which both eyes see. An error names the
/// pair whose images are missing in `folder`.
[[nodiscard]] Result<std::vector<TruePair>> middlebury_pairs(const std::string& folder);

/// The first frame of a scene, raw: the rig's error of calibration stays in it. All pixels on a
/// surface have their truth; for glass and mirrors it is that of their own surface.
[[nodiscard]] Result<TruePair> simulated_pair(const sim::SceneOptions& options);

/// Takes away the truth of what the right eye does not see: outside its image, or behind a pixel
/// further right.
void forget_hidden(TruePair& pair);

/// Unknown pixels take the smaller one of their nearest known neighbours along the row.
[[nodiscard]] Image<float> filled(const Image<float>& disparity_px);

/// Shares of the pixels with a truth [%].
struct Score {
    double bad_1 = 0.0;  ///< wrong by more than 1 px, after filling
    double bad_2 = 0.0;
    double matched_bad_1 = 0.0;  ///< share of the matched ones, nothing filled
    double matched_bad_2 = 0.0;
    double density = 0.0;  ///< matched
};

/// Against which truth.
enum class Truth : std::uint8_t { as_published, centred };
inline constexpr const char* kTruthNames[] = {"as published", "centred"};

/// Disparities are rounded to OpenCV's steps of 1/16 px first: against truth in whole pixels half a
/// step decides.
[[nodiscard]] Score score(const TruePair& pair, const Image<float>& disparity_px, Truth truth);

}  // namespace surefoot::experiments
