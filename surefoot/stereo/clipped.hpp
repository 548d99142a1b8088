// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Grey values of at least this are at the upper end of the sensor's range: a window, a lamp, wet
/// ground in the sun. One grey level below 255 allows for the interpolation of the rectification.
inline constexpr std::uint8_t kClippedWhite = 254;
/// Grey values up to this are at the dark end. They include the border without camera pixels.
inline constexpr std::uint8_t kClippedBlack = 1;

/// Removes disparities where the image has no detail: pixels whose whole 9 x 7 window is clipped
/// white or clipped black (the census window is smaller). A semi-global search carries a disparity
/// from the border of such an area through all of it, and no residual reveals this error. The image
/// border cuts the window. The filter allocates nothing while the image size stays the same.
class ClippedFilter {
  public:
    static constexpr int kReachX_px = 4;
    static constexpr int kReachY_px = 3;

    /// Sets removed disparities to NaN. Both images must have the same size.
    void remove(ImageView<const std::uint8_t> left, Executor& executor, Image<float>& disparity_px);

  private:
    Image<std::uint8_t> ends_;           ///< bit 0: white, bit 1: black
    std::vector<std::uint8_t> row_has_;  ///< per row: bits that are set in any pixel of the row
    Image<std::uint8_t> columns_;        ///< bits that are set in all pixels of a window's column
};

}  // namespace surefoot::stereo
