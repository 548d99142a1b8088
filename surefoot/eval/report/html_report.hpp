// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/report.hpp"
#include "surefoot/eval/report/svg_plot.hpp"

namespace surefoot::eval {

struct ReportPicture {
    std::string caption;
    std::vector<std::uint8_t> png;
    bool wide = false;  ///< takes the whole width of the page
};

/// A highlighted number.
struct KeyFigure {
    std::string label;
    std::string value;
    std::string unit;
    std::string note;  ///< small text below the value; may be empty
};

struct ReportTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string hint = {};  ///< small text below the table
    bool wide = false;      ///< takes the whole width of the page
    bool folded = false;    ///< shows only the title until the reader opens the section
};

/// A drawing made by a function of svg_plot.hpp.
struct ReportPlot {
    std::string title;
    std::string svg;
    std::string hint = {};  ///< small text below the drawing
};

/// Bars that compare quantities of one kind.
struct ReportBars {
    struct Bar {
        std::string label;
        double value = 0.0;  ///< length; >= 0
        std::string text;    ///< text beside the bar
    };
    std::string title;
    std::vector<Bar> bars;
};

/// A section of the page.
struct ReportSection {
    std::string title;
    std::vector<ReportPicture> pictures;
    std::vector<ReportTable> tables;
    std::string note = {};  ///< text below the pictures and tables
};

/// Contents of a report. Empty parts are left out.
struct ReportContent {
    std::string title;
    std::vector<std::string> summary;  ///< one sentence per line
    std::vector<ReportPicture> pictures;
    std::vector<ReportSection> sections;  ///< shown after the pictures
    std::vector<KeyFigure> figures;
    std::vector<std::string> reasons;  ///< sentences: missing parts, refusals, advice, notes
    std::vector<StageTiming> stages;
    std::vector<double> frame_ms;  ///< total time of all stages of each frame
    double frame_limit_ms = 0.0;   ///< time between two frames; 0 = unknown
    std::vector<HealthSample> health;
    std::string plots_title = "Errors";
    std::vector<ReportPlot> plots;
    std::string thumbnails_title = "Pictures";
    std::vector<ReportPicture> thumbnails;  ///< small pictures, several in a row
    std::string details_title = "Counts";   ///< title above bars and tables
    std::vector<ReportBars> bars;
    std::vector<ReportTable> tables;
    ReportTable configuration;  ///< configuration that the run used
    std::string footer;
};

/// Adds statistics of the frames of a run: stage and frame times, health, counts of points and
/// cells, and a table of the health reasons.
void add_frames(ReportContent& content, std::span<const FrameReport> frames);

/// Renders one self-contained HTML page: embedded pictures, no script, no external resource. The
/// page follows the reader's light or dark mode and is printable. All texts are escaped.
[[nodiscard]] std::string render_html(const ReportContent& content);

/// Encodes bytes as Base64 of RFC 4648, with padding.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace surefoot::eval
