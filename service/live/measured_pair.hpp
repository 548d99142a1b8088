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

/// Depth of one pair of images, and the check of the rectification.
struct MeasuredPair {
    camera::RectifiedPair pair;
    std::optional<camera::RectifiedRig> rig;  ///< nullopt = the input was already rectified
    DepthImage depth;
    stereo::PairCheck check;
};

/// Rectifies the frame if a rig is given, and matches the images as the pipeline does. Returns an
/// input error if the image sizes differ or do not fit the rig, if the images are not wider than
/// the disparity range, or if the cameras are swapped.
[[nodiscard]] Result<MeasuredPair> measure_pair(const StereoFrame& frame,
                                                const std::optional<camera::StereoRig>& rig,
                                                const pipeline::PipelineConfig& config,
                                                Executor& executor);
/// Measures two image files as measure_pair() does. The errors name the files.
[[nodiscard]] Result<MeasuredPair> measure_files(const std::string& left,
                                                 const std::string& right,
                                                 const std::optional<camera::StereoRig>& rig,
                                                 const pipeline::PipelineConfig& config,
                                                 Executor& executor);

/// Compares the rows of corresponding corners in a rectified pair. First searches a few rows.
/// Searches more rows, which takes longer, only if too few corners match.
[[nodiscard]] stereo::PairCheck check_rows(const camera::RectifiedPair& pair, int disparities);
/// Returns an input error if the left and the right camera are swapped.
[[nodiscard]] Status refuse_swapped(const stereo::PairCheck& check);
/// Describes the row error of a pair; empty if the rows match.
[[nodiscard]] std::string row_problem(const stereo::PairCheck& check, bool has_rig);

/// Density and precision of a depth image.
struct PairFigures {
    double density_percent = 0.0;  ///< share of pixels with a match
    double trusted_percent = 0.0;  ///< share of pixels with a trusted match
    double median_sigma_px = 0.0;  ///< median sigma of trusted matches; NaN = none
};
[[nodiscard]] PairFigures figures_of(const DepthImage& depth);

}  // namespace surefoot::app
