// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// How well two images fit together as a rectified pair: what corners of the left one say that are
/// found again in the right one, a few rows up and down and in both directions along the row.
struct PairCheck {
    int corners = 0;             ///< found in the left image
    int matched = 0;             ///< of these, found again without doubt
    double row_offset_px = 0.0;  ///< median row in the right image minus row in the left one
    double row_error_px = 0.0;   ///< median of its absolute value
    int backward = 0;            ///< of the matched, more than 1 px to the right of where they were

    /// The median is believed from this many corners on.
    static constexpr int kEnough = 20;
    [[nodiscard]] bool enough() const noexcept { return matched >= kEnough; }
    /// The right image is the left one: four of five corners moved the wrong way. Real pairs move
    /// that way only where the eyes squint.
    [[nodiscard]] bool swapped() const noexcept { return enough() && 5 * backward > 4 * matched; }
};

/// Farthest that corners are looked for [px].
struct PairSearch {
    int disparity_px = 128;
    int rows_px = 8;
};

/// A corner of the left image that was found again without doubt.
struct CornerShift {
    double u_px = 0.0;  ///< in the left image
    double v_px = 0.0;
    double columns_px = 0.0;  ///< right minus left
    double rows_px = 0.0;
};

struct Corners {
    int found = 0;  ///< in the left image
    std::vector<CornerShift> matched;
};

/// Images of equal size.
[[nodiscard]] Corners match_corners(ImageView<const std::uint8_t> left,
                                    ImageView<const std::uint8_t> right,
                                    const PairSearch& search = {});

/// Images of equal size. Those without corners give none, not an error.
[[nodiscard]] PairCheck check_pair(ImageView<const std::uint8_t> left,
                                   ImageView<const std::uint8_t> right,
                                   const PairSearch& search = {});

}  // namespace surefoot::stereo
