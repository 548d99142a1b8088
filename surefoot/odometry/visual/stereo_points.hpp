// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/odometry/visual/stereo_projection.hpp"

namespace surefoot::odometry {

struct StereoPointConfig {
    double min_disparity_px = 1.0;
    double max_disparity_px = 128.0;
    double epipolar_px = 1.5;  ///< |v_left - v_right| of a match in rectified rows
    double min_correlation = 0.8;
    /// A second place must differ this much more from the patch than the best one (1 -
    /// correlation).
    double uniqueness = 1.25;
};

/// Finds a corner of the left raw image in the right one: correlation at every disparity along the
/// epipolar curve, the best place refined below a pixel. Nothing without a unique, sharp match.
[[nodiscard]] std::optional<StereoPixel> match_corner(const camera::Rectifier& rectifier,
                                                      ImageView<const std::uint8_t> left,
                                                      ImageView<const std::uint8_t> right,
                                                      const Eigen::Vector2d& raw_left_px,
                                                      const StereoPointConfig& config);

/// Which eye saw a corner of `image`, by where it is in the `other` image. Nothing where that is
/// not beyond doubt.
[[nodiscard]] std::optional<camera::Side> camera_of_corner(const camera::Rectifier& rectifier,
                                                           ImageView<const std::uint8_t> image,
                                                           ImageView<const std::uint8_t> other,
                                                           const Eigen::Vector2d& raw_px,
                                                           const StereoPointConfig& config);

/// Rectified measurement from aligned raw pixels of both eyes; nothing when the rows differ more
/// than `epipolar_px` or the disparity is out of range. v is the mean row.
[[nodiscard]] std::optional<StereoPixel> stereo_pixel(const camera::Rectifier& rectifier,
                                                      const Eigen::Vector2d& raw_left_px,
                                                      const Eigen::Vector2d& raw_right_px,
                                                      const StereoPointConfig& config);

/// RGB-D: the measurement of a left pixel by its depth along z; u_right is that of the virtual
/// second eye. Nothing without a depth, or at a depth edge where the pixel may be either surface.
[[nodiscard]] std::optional<StereoPixel> depth_pixel(const camera::Rectifier& rectifier,
                                                     const Image<float>& depth_m,
                                                     const Eigen::Vector2d& raw_left_px,
                                                     const StereoPointConfig& config);

}  // namespace surefoot::odometry
