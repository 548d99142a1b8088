// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/result.hpp"

// Only for the .cpp files of this folder: OpenCV appears in no public header.
namespace surefoot::calibration {

/// Returns the number of squares in a row or column, from the number of its inner corners.
[[nodiscard]] inline int squares(int corners) {
    return corners + 1;
}

/// Returns the dictionary of a ChArUco board. Returns an error if OpenCV has no dictionary of this
/// name, or if the dictionary has too few markers for the board.
[[nodiscard]] Result<cv::Ptr<cv::aruco::Dictionary>> dictionary_of(const Board& board);

}  // namespace surefoot::calibration
