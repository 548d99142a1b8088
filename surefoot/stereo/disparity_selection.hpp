// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::stereo {

struct SelectionConfig {
    int uniqueness_percent = 5;  ///< the second best must cost this much more
    int left_right_px = 1;       ///< largest difference to what the right pixel is claimed with
};

/// Turns winners into disparities [px]; NaN where the match is not unique, where the right pixel
/// was matched more cheaply by another left one, outside the right image, and at disparity 0, which
/// is infinitely far. Between whole pixels lies the vertex of the parabola through the three costs.
void select_disparities(const SelectionConfig& config,
                        const Winners& winners,
                        Executor& executor,
                        Image<float>& disparity_px);

/// Row `v` of the median of 3 x 3 pixels; a pixel stays or becomes unknown where five of the nine
/// are. `scratch` is kept for the next row.
void median_of_row(const Image<float>& in, int v, std::vector<float>& scratch, float* out);

}  // namespace surefoot::stereo
