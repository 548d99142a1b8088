// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Tells how well two images fit together as a rectified pair. The check searches corners of the
/// left image in the right image, a few rows up and down and in both directions along the row.
struct PairCheck {
    int corners = 0;             ///< number of corners in the left image
    int matched = 0;             ///< number of corners with a clear match in the right image
    double row_offset_px = 0.0;  ///< median row in the right image minus row in the left one
    double row_error_px = 0.0;   ///< median of the absolute row difference
    int backward = 0;            ///< matches more than 1 px farther right in the right image

    /// Smallest number of matched corners that gives meaningful medians.
    static constexpr int kEnough = 20;
    [[nodiscard]] bool enough() const noexcept { return matched >= kEnough; }
    /// True if the images are swapped: more than four of five matched corners moved the wrong way.
    /// In an unswapped pair, corners move that way only where the optical axes converge.
    [[nodiscard]] bool swapped() const noexcept { return enough() && 5 * backward > 4 * matched; }
};

/// Largest search distance [px] for a corner.
struct PairSearch {
    int disparity_px = 128;
    int rows_px = 8;
};

/// A corner of the left image with a clear match in the right image.
struct CornerShift {
    double u_px = 0.0;  ///< column in the left image
    double v_px = 0.0;
    double columns_px = 0.0;  ///< column in the right image minus column in the left image
    double rows_px = 0.0;
};

struct Corners {
    int found = 0;  ///< number of corners in the left image
    std::vector<CornerShift> matched;
};

/// Matches corners of the left image in the right image. Both images must have the same size.
[[nodiscard]] Corners match_corners(ImageView<const std::uint8_t> left,
                                    ImageView<const std::uint8_t> right,
                                    const PairSearch& search = {});

/// Checks a pair of equal size. Images without corners give a result with 0 corners, not an error.
[[nodiscard]] PairCheck check_pair(ImageView<const std::uint8_t> left,
                                   ImageView<const std::uint8_t> right,
                                   const PairSearch& search = {});

}  // namespace surefoot::stereo
