// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"

namespace surefoot::app {

/// Distances at points of a cloud, with the titles of their pictures. Both spans have equal length.
struct PlacedDistances {
    std::span<const Eigen::Vector3f> points_m;
    std::span<const float> distances_m;  ///< NaN = this point has no distance
    bool is_signed = false;
    std::string title;
    std::string subtitle;
};

/// Writes three files into `folder`: distances.png, histogram.svg and distances.ply. distances.png
/// is a view from above of the mean distance in each cell. distances.ply has all points, with their
/// distances and the colours of the picture. `shift_m` is added to the points of distances.ply.
[[nodiscard]] Status write_cloud_pictures(const std::string& folder,
                                          const PlacedDistances& placed,
                                          const Eigen::Vector3d& shift_m);

/// Draws the histogram of heights above the lowest bin as an SVG. `points`: number of all level
/// points; this number is 100 % of the vertical axis.
[[nodiscard]] std::string heights_svg(const eval::HeightHistogram& heights,
                                      std::int64_t points,
                                      const std::string& title);

}  // namespace surefoot::app
