// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/odometry/visual/stereo_projection.hpp"

namespace surefoot::odometry {

struct StereoPointConfig {
    double min_disparity_px = 1.0;
    double max_disparity_px = 128.0;
    double epipolar_px = 1.5;  ///< largest |v_left - v_right| of a match, in rectified rows
    double min_correlation = 0.8;
    /// Smallest ratio of (1 - correlation) at the second best position to (1 - correlation) at the
    /// best position.
    double uniqueness = 1.25;
};

/// Finds a corner of the left raw image in the right one: correlation at every disparity along the
/// epipolar curve, then sub-pixel refinement. Returns nothing without a unique, sharp match.
[[nodiscard]] std::optional<StereoPixel> match_corner(const camera::Rectifier& rectifier,
                                                      ImageView<const std::uint8_t> left,
                                                      ImageView<const std::uint8_t> right,
                                                      const Eigen::Vector2d& raw_left_px,
                                                      const StereoPointConfig& config);

/// Decides which camera saw a corner of `image` from its position in the `other` image. Returns
/// nothing if the decision is not clear.
[[nodiscard]] std::optional<camera::Side> camera_of_corner(const camera::Rectifier& rectifier,
                                                           ImageView<const std::uint8_t> image,
                                                           ImageView<const std::uint8_t> other,
                                                           const Eigen::Vector2d& raw_px,
                                                           const StereoPointConfig& config);

/// Rectified measurement from aligned raw pixels of both cameras, with v the mean row. Returns
/// nothing if the rows differ by more than `epipolar_px` or the disparity is too small.
[[nodiscard]] std::optional<StereoPixel> stereo_pixel(const camera::Rectifier& rectifier,
                                                      const Eigen::Vector2d& raw_left_px,
                                                      const Eigen::Vector2d& raw_right_px,
                                                      const StereoPointConfig& config);

/// RGB-D: the measurement of a left pixel from its depth along z; u_right belongs to the virtual
/// second camera. Returns nothing without depth or at a depth edge (an ambiguous surface).
[[nodiscard]] std::optional<StereoPixel> depth_pixel(const camera::Rectifier& rectifier,
                                                     const Image<float>& depth_m,
                                                     const Eigen::Vector2d& raw_left_px,
                                                     const StereoPointConfig& config);

}  // namespace surefoot::odometry
