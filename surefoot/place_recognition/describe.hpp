// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

struct DescribeConfig {
    int fast_threshold = 7;  ///< grey steps; low, because walls have little contrast
    int pyramid_levels = 6;  ///< each 1.2 times smaller: found again from 0.4 to 2.5 times as far
    /// Looked at before those without depth are left out: so many that a rich floor does not take
    /// them all.
    int corners = 6000;
    int grid_columns = 12;  ///< features are spread over this grid
    int grid_rows = 8;
    /// Of a cell; the cells of a floor alone (some two thirds of the image) cannot fill the list,
    /// so that walls, doors and what stands about always have a voice.
    int cell_features = 6;
    double max_outlier_probability = 0.3;  ///< of a feature's disparity
    double min_disparity_px = 2.0;         ///< nearer than some 20 m of a ZED
};

/// Corners of the rectified left image that have depth, spread over the image, with their
/// descriptors; at most kMostFeatures, in an order that depends on the image alone.
///
/// Oriented BRIEF (Rublee et al. 2011, ORB) with the orientation left out: the machine stands
/// upright, so that up is known, and what is turned in the image is another thing. Turns of the
/// camera about its axis up to some 15 deg are borne.
[[nodiscard]] std::vector<Feature> describe(const DescribeConfig& config,
                                            ImageView<const std::uint8_t> left,
                                            const DepthImage& depth);

}  // namespace surefoot::place_recognition
