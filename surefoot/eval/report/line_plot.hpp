// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace surefoot::eval {

/// Lines over a quantity; both axes start at 0. A standalone SVG that also fits into a report.
struct LinePlot {
    struct Point {
        double x = 0.0;
        double y = 0.0;
    };
    struct Line {
        std::string label;
        std::vector<Point> points;  ///< ascending in x; a non-finite point interrupts the line
        bool dashed = false;        ///< used for results of other authors
    };
    std::string title;
    std::string x_label;  ///< label of the x axis with its unit
    std::string y_label;
    std::vector<Line> lines;  ///< at most kColours
    static constexpr std::size_t kColours = 5;
};
/// Returns an empty string if no line has a finite point.
[[nodiscard]] std::string line_plot_svg(const LinePlot& plot);

}  // namespace surefoot::eval
