// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/line_plot.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::eval {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
}

TEST(LinePlot, DrawsEveryPointAndBreaksWhereNothingIs) {
    LinePlot plot{"a < b", "distance [m]", "mm", {{"ours", {{1, 2}, {2, NAN}, {3, 8}, {4, 4}}}}};
    plot.lines.push_back({"theirs", {{2, 1}, {4, 3}}, true});
    const std::string svg = line_plot_svg(plot);
    EXPECT_EQ(count(svg, "<circle"), 5U);
    EXPECT_EQ(count(svg, "<polyline"), 3U);
    EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
    EXPECT_NE(svg.find("theirs"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    // The highest value ends just below the top of the drawing: 8 of 8.4 between 284 and 64.
    EXPECT_NE(svg.find("cy=\"74.5\""), std::string::npos) << svg;
}

TEST(LinePlot, NothingToDraw) {
    EXPECT_EQ(line_plot_svg({"t", "x", "y", {}}), "");
    EXPECT_EQ(line_plot_svg({"t", "x", "y", {{"l", {{NAN, 1.0}}}}}), "");
    // A line along the axis is a line.
    EXPECT_NE(line_plot_svg({"t", "x", "y", {{"l", {{1.0, 0.0}}}}}), "");
}

}  // namespace
}  // namespace surefoot::eval
