// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// The side of a board that is nearest to the camera, named as in the image.
enum class NearSide : std::uint8_t { left, right, top, bottom };
inline constexpr const char* kNearSideNames[] = {"left", "right", "top", "bottom"};

/// Smallest angle of a view that counts as tilted; for the reason see coverage.cpp.
inline constexpr double kEnoughTilt_deg = 20.0;

/// Size and tilt of a board in the image, estimated without a lens model.
struct ViewShape {
    double spacing_px = 0.0;  ///< distance of neighbours in the middle: geometric mean of both axes
    /// Angle between the board and the image plane, from the foreshortening in the middle of the
    /// view. Exact for a small board on the optical axis.
    double tilt_deg = 0.0;
    NearSide near_side = NearSide::left;  ///< meaningful only for a tilted board
};

/// Coverage of a set of views, and advice on missing views.
struct Coverage {
    static constexpr int kColumns = 12;
    static constexpr int kRows = 9;
    Image<int> points{kColumns, kRows};  ///< board points seen in each part of the image
    std::vector<ViewShape> views;        ///< one per view; all zero for a view with too few points
    double seen_share = 0.0;             ///< share of image parts with a point, 0 to 1
    std::vector<std::string> advice;     ///< sentences, most important first; empty = enough
};

/// Rates the coverage of views, also of unchecked views. Ignores points outside the image.
[[nodiscard]] Coverage coverage_of(const Board& board,
                                   std::span<const BoardView> views,
                                   int width,
                                   int height);

}  // namespace surefoot::calibration
