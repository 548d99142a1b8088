// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "surefoot/camera/depth_image.hpp"
#include "surefoot/stereo/semi_global.hpp"
#include "surefoot/stereo/settle.hpp"

/// Our matcher and OpenCV's, with any of their settings.
namespace surefoot::experiments {

/// A way to match with one setting of it: disparities of the left image [px], NaN = unknown.
using Match = std::function<Image<float>(const TruePair&)>;

/// What the chain uses, as it comes.
[[nodiscard]] Match chain();
/// Of these, what it does not think likely to be wrong: what maps are made of.
[[nodiscard]] Match trusted_chain();
/// Largest outlier probability of a trusted match.
inline constexpr float kTrusted = 0.5F;
/// The chain's disparities with their sigma and outlier probability.
[[nodiscard]] camera::DepthImage chain_depth(const TruePair& pair);

struct OurSettings {
    stereo::SemiGlobalConfig search;
    stereo::SettleConfig settle;
};
/// Winners of our search without the islands: what is refined.
[[nodiscard]] Image<float> settled_px(const OurSettings& settings, const TruePair& pair);
/// Our search, settled, without speckles, and the median of 3 x 3 pixels.
[[nodiscard]] Match our_search(const OurSettings& settings);
/// The same, refined as the chain does: with its settings these are the disparities of `chain`.
[[nodiscard]] Match our_whole(const OurSettings& settings);

/// OpenCV's semi-global matcher, padded on the left so that no column is lost.
struct SgbmSettings {
    int mode = 0;  ///< cv::StereoSGBM::MODE_...
    int block = 3;
    double slope = 8.0;  ///< P1 per pixel of a block
    double jump = 32.0;  ///< P2 likewise
    int prefilter_cap = 63;
    int uniqueness_percent = 10;
};
[[nodiscard]] Match opencv_sgbm(const SgbmSettings& settings);

/// OpenCV's block matcher, padded on all sides.
struct BmSettings {
    int block = 15;
    int prefilter_cap = 31;
    int uniqueness_percent = 15;
};
[[nodiscard]] Match opencv_bm(const BmSettings& settings);

/// One of a matcher's settings, in words without commas.
struct Setting {
    std::string words;
    Match match;
};

/// A matcher, and the settings among which one is chosen: 36 of each.
struct Candidate {
    std::string name;
    Match as_it_comes;
    std::vector<Setting> settings;
};
/// Ours, whole and the search alone, then OpenCV's modes.
[[nodiscard]] std::vector<Candidate> candidates();

}  // namespace surefoot::experiments
