// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/result.hpp"

// Only for the .cpp files of this folder: OpenCV appears in no public header.
namespace surefoot::calibration {

/// Squares of a board in a row: one more than corners.
[[nodiscard]] inline int squares(int corners) {
    return corners + 1;
}

/// The dictionary that a ChArUco board names; an error where OpenCV knows none of that name or it
/// has too few markers for the board.
[[nodiscard]] Result<cv::Ptr<cv::aruco::Dictionary>> dictionary_of(const Board& board);

}  // namespace surefoot::calibration
