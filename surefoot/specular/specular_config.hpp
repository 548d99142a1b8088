// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/core/config.hpp"

namespace surefoot::specular {

/// Settings of the search for mirrors and panes of glass. Scores are in standard deviations of the
/// noise, which is measured on other lines of the same floor.
struct SpecularConfig {
    bool enabled = true;
    double cell_m = 0.01;              ///< cell size of the floor picture
    double range_m = 3.2;              ///< largest usable depth of floor, along the optical axis
    double mirror_correlation = 0.35;  ///< smallest correlation of floor and mirror image
    double mirror_score = 7.0;         ///< smallest score of a mirror line (see mirror_correlation)
    double glass_score = 11.0;  ///< smallest score of any other line: glass reflects 5 to 15 %
    double keep_score =
        3.5;  ///< `forget_observations` observations in a row with a lower score delete a pane
    int forget_observations = 4;
    /// Smallest ratio of the best score to the score of any other line of the same direction. Tiled
    /// floors are symmetric about many lines; a mirror makes one line.
    double unique_ratio = 1.4;
    /// Each frame searches this many of the 41 directions ahead, and as many of the 180 directions
    /// all around. One direction takes about 0.5 ms.
    int directions_per_frame = 1;
    double margin_m = 0.02;       ///< cells this far before the line also become unknown
    double side_margin_m = 0.15;  ///< cells this far beside the observed part become unknown too

    void describe(ConfigVisitor& visitor);
    /// Returns the first contradiction between settings that are each in range, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::specular
