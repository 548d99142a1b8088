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
    int disparities = 64;   ///< search range [px]: 0 to disparities - 1
    double step_px = 0.0;   ///< quantization of the stored truth [px]; 0 = exact
    double truth_offset_px =
        0.0;  ///< offset that Truth::centred adds [px]; not 0 if the truth was rounded down
};

/// Reads the Middlebury pairs cones, teddy, cloth3, adirondack, and adirondack with a different
/// exposure of the right image, in this order. Only pixels that both cameras see keep their truth.
/// An error names the pair whose images are missing in `folder`.
[[nodiscard]] Result<std::vector<TruePair>> middlebury_pairs(const std::string& folder);

/// Renders the first frame of a scene. The images contain the calibration error of the profile.
/// Every pixel on a surface has a truth. For glass and mirrors it is the disparity of the pane.
[[nodiscard]] Result<TruePair> simulated_pair(const sim::SceneOptions& options);

/// Scenes of the simulated images: steps, floors, rooms and objects.
inline constexpr const char* kScenes[] = {"demo_stairs",
                                          "sill_13",
                                          "kerb_down_150",
                                          "floor",
                                          "stairs_up_ada",
                                          "table",
                                          "room",
                                          "corridor",
                                          "platform_edge",
                                          "ramp_1_12_up"};

/// Sets the truth of pixels that the right camera does not see to NaN. These pixels are outside the
/// right image, or a surface farther right occludes them.
void forget_hidden(TruePair& pair);

/// Fills each unknown pixel with the smaller of the nearest known values on its left and right.
[[nodiscard]] Image<float> filled(const Image<float>& disparity_px);

/// Shares in percent of the pixels that have a truth.
struct Score {
    double bad_1 = 0.0;          ///< error above 1 px, after filled()
    double bad_2 = 0.0;          ///< error above 2 px, after filled()
    double matched_bad_1 = 0.0;  ///< error above 1 px, in percent of the matched pixels
    double matched_bad_2 = 0.0;  ///< error above 2 px, in percent of the matched pixels
    double density = 0.0;        ///< matched pixels
};

/// Truth to compare with: as published, or with TruePair::truth_offset_px added.
enum class Truth : std::uint8_t { as_published, centred };
inline constexpr const char* kTruthNames[] = {"as published", "centred"};

/// Scores disparities against a truth. First rounds the disparities to OpenCV's steps of 1/16 px,
/// because half a step changes the score if the truth is in whole pixels.
[[nodiscard]] Score score(const TruePair& pair, const Image<float>& disparity_px, Truth truth);

}  // namespace surefoot::experiments
