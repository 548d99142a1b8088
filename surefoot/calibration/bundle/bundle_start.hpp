// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Finds lens and board poses of a one-camera bundle with given sights (ordered by view), without a
/// start value. Tries focal lengths from 0.1 to 6 times the longer image side. Each focal length
/// gives all board poses in closed form, with an undistorted (pinhole) or equidistant (fisheye)
/// lens. Near the true focal length, the poses explain the views best. Refines the best three in
/// stages, with few parameters first. A rational lens starts from a pinhole5 lens and from a
/// fisheye; the better result counts. Returns false if no focal length explains any view.
[[nodiscard]] bool start_bundle(BoardBundle& bundle);

}  // namespace surefoot::calibration
