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
    double range_m = 3.2;              ///< floor farther from the camera is too coarse
    double mirror_correlation = 0.35;  ///< least correlation of floor and image for a mirror
    double mirror_score = 7.0;  ///< score from which a line with such a correlation is suspected
    double glass_score = 11.0;  ///< needed score of any other line: glass reflects 5 to 15 %
    double keep_score = 3.5;    ///< panes below it for `forget_looks` observations are forgotten
    int forget_looks = 4;
    /// Least ratio of the best line's score to that of any other line of the same direction. Tiled
    /// floors are symmetric about many lines; a mirror makes one line.
    double unique_ratio = 1.4;
    /// Number of the 41 directions ahead, and of the 180 all around, that are searched per frame.
    /// Each search costs about 0.5 ms.
    int directions_per_frame = 1;
    double margin_m = 0.02;       ///< cells this far before the line also become unknown
    double side_margin_m = 0.15;  ///< cells this far beside its observed part do too

    void describe(ConfigVisitor& visitor);
    /// The first contradiction between settings that are each in range, in words; or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::specular
