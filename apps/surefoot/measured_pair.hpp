// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/pipeline/pipeline_config.hpp"
#include "surefoot/stereo/pair_check.hpp"

namespace surefoot::app {

/// Depth of one pair of images, and how well they fit together.
struct MeasuredPair {
    camera::RectifiedPair pair;
    std::optional<camera::RectifiedRig> rig;  ///< nothing: the pair came rectified, without a rig
    DepthImage depth;
    stereo::PairCheck check;
};

/// Matches whose outlier probability is above this are shown, but no point and no figure counts
/// them.
inline constexpr float kTrustedOutlierProbability = 0.5F;

/// Rectifies with the rig, where there is one, and matches as the pipeline does. Input errors:
/// sizes that differ or do not fit the rig, images smaller than what the matcher looks at,
/// exchanged eyes.
[[nodiscard]] Result<MeasuredPair> measure_pair(const StereoFrame& frame,
                                                const std::optional<camera::StereoRig>& rig,
                                                const pipeline::PipelineConfig& config,
                                                Executor& executor);
/// The same of two image files, which the errors name.
[[nodiscard]] Result<MeasuredPair> measure_files(const std::string& left,
                                                 const std::string& right,
                                                 const std::optional<camera::StereoRig>& rig,
                                                 const pipeline::PipelineConfig& config,
                                                 Executor& executor);

/// How well a rectified pair fits together. Looks farther up and down, which takes its time, only
/// where a few rows do not suffice.
[[nodiscard]] stereo::PairCheck check_rows(const camera::RectifiedPair& pair, int disparities);
/// An error where left and right are exchanged.
[[nodiscard]] Status refuse_exchanged(const stereo::PairCheck& check);
/// What is wrong with the rows, in words; empty where nothing is.
[[nodiscard]] std::string row_problem(const stereo::PairCheck& check, bool has_rig);

/// Share of pixels with a match [%], and the median sigma of the trusted ones [px].
struct PairFigures {
    double density_percent = 0.0;
    double trusted_percent = 0.0;
    double median_sigma_px = 0.0;  ///< NaN without one
};
[[nodiscard]] PairFigures figures_of(const DepthImage& depth);

}  // namespace surefoot::app
