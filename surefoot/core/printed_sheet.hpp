// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace surefoot {

/// Print on a flat sheet, for drawing and rendering: black shapes on white paper. All shapes lie in
/// the plane z = 0 of the sheet's own frame. Seen by the camera, x points to the right, y down and
/// z away from the viewer.
struct PrintedSheet {
    struct Rectangle {
        double left_m = 0.0;
        double top_m = 0.0;
        double right_m = 0.0;
        double bottom_m = 0.0;
    };
    struct Disc {
        double x_m = 0.0;
        double y_m = 0.0;
        double radius_m = 0.0;
    };
    Rectangle paper;  ///< outline of the sheet, including its white margin
    std::vector<Rectangle> rectangles;
    std::vector<Disc> discs;
};

}  // namespace surefoot
