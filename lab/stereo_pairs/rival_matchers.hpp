// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/disparity_selection.hpp"
#include "surefoot/stereo/semi_global.hpp"

/// Our matcher and OpenCV's matchers, with adjustable settings.
namespace surefoot::experiments {

/// A matcher with fixed settings. Returns disparities of the left image [px]; NaN = unknown.
using Match = std::function<Image<float>(const TruePair&)>;

/// Returns the matcher of the pipeline with its default settings.
[[nodiscard]] Match chain();
/// Returns the same matcher without the disparities whose outlier probability is too high to
/// be trusted.
[[nodiscard]] Match trusted_chain();
/// Runs the matcher of the pipeline: disparities with sigma and outlier probability.
[[nodiscard]] DepthImage chain_depth(const TruePair& pair);

/// Settings of our matcher.
struct OurSettings {
    stereo::SemiGlobalConfig search;
    stereo::SelectionConfig selection;
};
/// Returns the disparities of our search after stereo::select_disparities and the speckle filter.
/// They are the input of the refinement in the pipeline.
[[nodiscard]] Image<float> selected_px(const OurSettings& settings, const TruePair& pair);
/// Returns `selected_px` after a 3 x 3 median, without the refinement of the pipeline.
[[nodiscard]] Match our_search(const OurSettings& settings);
/// Returns `selected_px` after the refinement of the pipeline. With the default settings the
/// disparities equal those of `chain`.
[[nodiscard]] Match our_whole(const OurSettings& settings);

/// OpenCV's semi-global matcher. The images are padded on the left so that no column is lost.
struct SgbmSettings {
    int mode = 0;  ///< one of cv::StereoSGBM::MODE_...
    int block = 3;
    double slope = 8.0;  ///< P1 of OpenCV divided by the pixels of a block
    double jump = 32.0;  ///< P2 of OpenCV divided by the pixels of a block
    int prefilter_cap = 63;
    int uniqueness_percent = 10;
};
[[nodiscard]] Match opencv_sgbm(const SgbmSettings& settings);

/// OpenCV's block matcher. The images are padded on all sides.
struct BmSettings {
    int block = 15;
    int prefilter_cap = 31;
    int uniqueness_percent = 15;
};
[[nodiscard]] Match opencv_bm(const BmSettings& settings);

/// One setting of a matcher. `words` describes it without commas, for CSV files.
struct Setting {
    std::string words;
    Match match;
};

/// A matcher with its default settings and the 36 settings that the tuning compares.
struct Candidate {
    std::string name;
    Match as_it_comes;
    std::vector<Setting> settings;
};
/// Returns our whole matcher, our search alone, and then the modes of OpenCV.
[[nodiscard]] std::vector<Candidate> candidates();

}  // namespace surefoot::experiments
