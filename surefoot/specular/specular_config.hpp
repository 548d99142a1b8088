// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/core/config.hpp"

namespace surefoot::specular {

/// Settings of the search for mirrors and panes of glass. The scores count in standard deviations
/// of the noise, which is measured on other lines of the same floor.
struct SpecularConfig {
    bool enabled = true;
    double cell_m = 0.01;              ///< of the picture of the floor
    double range_m = 3.2;              ///< floor farther from the camera is too coarse
    double mirror_correlation = 0.35;  ///< of the floor and its image: a mirror, above it
    double mirror_score = 7.0;  ///< a line of such a correlation that reaches it is suspected
    double glass_score = 11.0;  ///< the same for any other line: glass mirrors 5 to 15 %
    double keep_score = 3.5;    ///< one that stays below it for `forget_looks` looks is forgotten
    int forget_looks = 4;
    /// The best line must reach this many times the score of any other line of the same direction:
    /// floors of tiles are symmetric about many lines, a mirror makes one.
    double unique_ratio = 1.4;
    /// Of the 41 ahead, and as many of the 180 all around; each look costs about half a
    /// millisecond.
    int directions_per_frame = 1;
    double margin_m = 0.02;       ///< cells this far before the line become unknown too
    double side_margin_m = 0.15;  ///< and this far beside the seen part of the line

    void describe(ConfigVisitor& visitor);
    /// First contradiction between values that are each in range, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::specular
