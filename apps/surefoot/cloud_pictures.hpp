// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"

namespace surefoot::app {

/// Distances at places, and what to call them.
struct PlacedDistances {
    std::span<const Eigen::Vector3f> points_m;
    std::span<const float> distances_m;  ///< NaN = none
    bool is_signed = false;
    std::string title;
    std::string subtitle;
};

/// Into a folder: distances.png (from above, each cell the mean of its points), histogram.svg, and
/// distances.ply, the points in the colours of the picture with their distance.
[[nodiscard]] Status write_cloud_pictures(const std::string& folder,
                                          const PlacedDistances& placed,
                                          const Eigen::Vector3d& shift_m);

/// How many level points lie how high, upward from the lowest: an SVG. `points`: all of them.
[[nodiscard]] std::string heights_svg(const eval::HeightHistogram& heights,
                                      std::int64_t points,
                                      const std::string& title);

}  // namespace surefoot::app
