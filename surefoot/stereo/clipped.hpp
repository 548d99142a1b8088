// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Grey values from here on are at the end of the sensor's range: a window, a lamp, wet ground in
/// the sun. One grey level is left for what rectification interpolates.
inline constexpr std::uint8_t kClippedWhite = 254;
/// The same at the dark end, and the border that no camera pixel fell on.
inline constexpr std::uint8_t kClippedBlack = 1;

/// Removes what a search found where the image holds nothing to be found: pixels whose whole 9 x 7
/// window, the one of the census words, is white or black without detail. A semi-global search
/// carries a disparity from the border of such an area through all of it, with no residual that
/// would tell. At the image's border the window is cut. No allocation where the size stays.
class ClippedFilter {
  public:
    static constexpr int kReachX_px = 4;
    static constexpr int kReachY_px = 3;

    /// Both have the same size; removed disparities become NaN.
    void remove(ImageView<const std::uint8_t> left, Executor& executor, Image<float>& disparity_px);

  private:
    Image<std::uint8_t> ends_;           ///< bit 0: white, bit 1: black
    std::vector<std::uint8_t> row_has_;  ///< of each row: the bits that any of its pixels has
    Image<std::uint8_t> columns_;        ///< what all of a column of the window have in common
};

}  // namespace surefoot::stereo
