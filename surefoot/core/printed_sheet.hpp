// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace surefoot {

/// What is printed on a flat sheet, to draw it or to render it: black shapes on white paper, all in
/// the plane z = 0 of the sheet's own frame, x to the right and y down as the camera sees it, z
/// away from the viewer.
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
    Rectangle paper;  ///< with its white margin
    std::vector<Rectangle> rectangles;
    std::vector<Disc> discs;
};

}  // namespace surefoot
