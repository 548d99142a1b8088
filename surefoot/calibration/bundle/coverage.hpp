// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::calibration {

/// The side of a board that is nearest to the camera, as the image shows it.
enum class NearSide : std::uint8_t { left, right, top, bottom };
inline constexpr const char* kNearSideNames[] = {"left", "right", "top", "bottom"};

/// A view counts as tilted from here on: see coverage.cpp.
inline constexpr double kEnoughTilt_deg = 20.0;

/// How a board was held, told from the image alone.
struct ViewShape {
    double spacing_px = 0.0;  ///< of neighbouring points in the middle of the view, geometric mean
    /// Angle between the board and the image plane, from the foreshortening in the middle of the
    /// view (exact for a board that is small and on the optical axis).
    double tilt_deg = 0.0;
    NearSide near_side = NearSide::left;  ///< means something only with a tilt
};

/// What a set of views has shown, and what is missing.
struct Coverage {
    static constexpr int kColumns = 12;
    static constexpr int kRows = 9;
    Image<int> points{kColumns, kRows};  ///< board points seen in each part of the image
    std::vector<ViewShape> views;        ///< one per view given, all zero where it has few points
    double seen_share = 0.0;             ///< parts with a point
    std::vector<std::string> advice;     ///< sentences, most important first; empty = enough
};

/// Views need not have passed any check; points outside of the image are left out.
[[nodiscard]] Coverage coverage_of(const Board& board,
                                   std::span<const BoardView> views,
                                   int width,
                                   int height);

}  // namespace surefoot::calibration
