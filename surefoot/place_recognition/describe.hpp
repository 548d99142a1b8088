// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

struct DescribeConfig {
    int fast_threshold = 7;  ///< [grey levels]; low, because walls have little contrast
    int pyramid_levels = 6;  ///< each 1.2 times smaller; matches from 0.4 to 2.5 times the distance
    /// Number of corners before corners without depth are removed. The number is large, so that a
    /// floor with much texture does not use up all corners.
    int corners = 6000;
    int grid_columns = 12;  ///< features are spread over this grid of cells
    int grid_rows = 8;
    /// Largest number of features per cell. The cells of a floor (about two thirds of the image)
    /// cannot fill the list alone, so walls, doors and objects always contribute.
    int cell_features = 6;
    double max_outlier_probability = 0.3;  ///< largest outlier probability of a feature's disparity
    double min_disparity_px = 2.0;         ///< excludes points more than about 20 m from a ZED
};

/// Detects corners of the rectified left image that have depth, spread over the image. Describes
/// them. Returns at most kMostFeatures, in an order that depends on these inputs alone.
///
/// Method: oriented BRIEF (Rublee et al. 2011, ORB) without the orientation. The machine stands
/// upright, so a rotated pattern in the image is another object. The descriptors tolerate rotations
/// of the camera about its axis up to about 15 deg.
[[nodiscard]] std::vector<Feature> describe(const DescribeConfig& config,
                                            ImageView<const std::uint8_t> left,
                                            const DepthImage& depth);

}  // namespace surefoot::place_recognition
