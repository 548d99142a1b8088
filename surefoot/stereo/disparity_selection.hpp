// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::stereo {

struct SelectionConfig {
    int uniqueness_percent = 5;  ///< smallest margin of the best cost below the second best [%]
    int left_right_px = 1;       ///< largest difference to the cheapest match of the right pixel
};

/// Converts winners into disparities [px]. NaN if the match is not unique, lies outside the right
/// image or has disparity 0 (infinitely far). NaN too if a cheaper match claims the same right
/// pixel (see `left_right_px`). A parabola through three costs gives the fraction of a pixel.
void select_disparities(const SelectionConfig& config,
                        const Winners& winners,
                        Executor& executor,
                        Image<float>& disparity_px);

/// Computes row `v` of the 3 x 3 median. A pixel becomes or stays unknown if at least five of the
/// nine pixels are unknown. Callers keep `scratch` from row to row.
void median_of_row(const Image<float>& in, int v, std::vector<float>& scratch, float* out);

}  // namespace surefoot::stereo
