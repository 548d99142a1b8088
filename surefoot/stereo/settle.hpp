// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::stereo {

struct SettleConfig {
    int uniqueness_percent = 5;  ///< the second best must cost this much more
    int left_right_px = 1;       ///< largest difference to what the right pixel is claimed with
};

/// Turns winners into disparities [px]; NaN where the match is not unique, where the right pixel
/// was matched more cheaply by another left one, outside the right image, and at disparity 0, which
/// is infinitely far. Between whole pixels lies the vertex of the parabola through the three costs.
void settle(const SettleConfig& config,
            const Winners& winners,
            Executor& executor,
            Image<float>& disparity_px);

/// Median of 3 x 3 pixels; a pixel stays or becomes unknown where five of the nine are.
void median_filter(const Image<float>& in, Executor& executor, Image<float>& out);

}  // namespace surefoot::stereo
