// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Finds lens and board poses of a one-camera bundle whose sights are given (ordered by view), from
/// nothing. Focal lengths from a tenth to six times the image side are tried: for each, every board
/// pose follows in closed form from the undistorted (pinhole) or equidistant (fisheye) lens, and
/// the poses explain the views best near the truth. The best three are refined in stages, fewer
/// parameters first; the rational lens grows out of the five-parameter one and out of a fisheye,
/// and the better one counts. False when no focal length explains any view.
[[nodiscard]] bool start_bundle(BoardBundle& bundle);

}  // namespace surefoot::calibration
