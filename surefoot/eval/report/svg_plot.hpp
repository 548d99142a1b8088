// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/core/frame.hpp"

namespace surefoot::eval {

/// Wall times of one stage in the frames in which it ran [ms].
struct StageTiming {
    std::string name;
    std::vector<double> ms;
};

struct HealthSample {
    double time_s = 0.0;  ///< time since the start of the run
    Health health = Health::lost;
    HealthReason reason = HealthReason::none;
};

/// Escapes `text` for HTML and SVG: replaces the five special characters, and turns control
/// characters except line break and tab into spaces.
[[nodiscard]] std::string escaped(const std::string& text);

/// Inline SVG drawings without script or external resource. Colours come from the page's style
/// sheet (classes axis, label, value, median, tail, line, second, limit, mark, ok, degraded, lost).

/// Draws one bar per stage: solid to the median, thin to the 99th percentile. Leaves out stages
/// without samples. Returns an empty string if no stage has samples.
[[nodiscard]] std::string stage_bars_svg(const std::vector<StageTiming>& stages);

/// Draws the time of each frame; with over 600 frames, the largest time of neighbouring frames.
/// Draws `limit_ms` > 0 as a line. Returns an empty string for fewer than two frames.
[[nodiscard]] std::string frame_times_svg(const std::vector<double>& frame_ms, double limit_ms);

/// Draws health over time as a coloured band with a legend. Samples are in time order. Returns an
/// empty string without samples.
[[nodiscard]] std::string health_svg(const std::vector<HealthSample>& samples);

/// Values over bins of a quantity: lines with a mark in the middle of each bin.
struct BinPlot {
    struct Line {
        std::string label;
        std::vector<double> values;  ///< one value per bin; NaN = no value, the line has a gap
    };
    std::string x_label;        ///< label of the x axis with its unit
    std::string unit;           ///< unit of the values
    std::vector<double> edges;  ///< bin edges, ascending; one more than values
    std::vector<Line> lines;    ///< at most two lines
    double high = 0.0;          ///< upper end of the y axis; 0 = just above the largest value
};
/// Returns an empty string if no line has a value.
[[nodiscard]] std::string bin_plot_svg(const BinPlot& plot);

}  // namespace surefoot::eval
