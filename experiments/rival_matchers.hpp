// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/stereo_pairs.hpp"
#include "surefoot/stereo/semi_global.hpp"
#include "surefoot/stereo/settle.hpp"

/// Our matcher and OpenCV's, with any of their settings.
namespace surefoot::experiments {

/// A way to match with one setting of it: disparities of the left image [px], NaN = unknown.
using Match = std::function<Image<float>(const TruePair&)>;

/// What the chain uses, as it comes.
[[nodiscard]] Match chain();

/// Our search, settled, without speckles, and the median of 3 x 3 pixels.
[[nodiscard]] Match our_search(const stereo::SemiGlobalConfig& search);

/// OpenCV's semi-global matcher with blocks of 3 x 3, padded on the left so that no column is lost.
struct SgbmSettings {
    int mode = 0;        ///< cv::StereoSGBM::MODE_...
    double slope = 8.0;  ///< P1 per pixel of a block
    double jump = 32.0;  ///< P2 likewise
    int prefilter_cap = 63;
};
[[nodiscard]] Match opencv_sgbm(const SgbmSettings& settings);

/// A matcher, and the settings among which one is chosen.
struct Candidate {
    std::string name;
    std::vector<Match> settings;
};
[[nodiscard]] std::vector<Candidate> candidates();

}  // namespace surefoot::experiments
