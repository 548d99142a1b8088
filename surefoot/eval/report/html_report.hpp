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

/// One number to remember.
struct KeyFigure {
    std::string label;
    std::string value;
    std::string unit;
    std::string note;  ///< small, below; may be empty
};

struct ReportTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string hint = {};  ///< small, below
    bool wide = false;      ///< takes the whole width of the page
    bool folded = false;    ///< only its title is shown until the reader opens it
};

/// A drawing of svg_plot.hpp.
struct ReportPlot {
    std::string title;
    std::string svg;
    std::string hint = {};  ///< small, below
};

/// Amounts of one kind beside each other.
struct ReportBars {
    struct Bar {
        std::string label;
        double value = 0.0;  ///< length; >= 0
        std::string text;    ///< what is written beside it
    };
    std::string title;
    std::vector<Bar> bars;
};

/// A part of the page about one thing.
struct ReportSection {
    std::string title;
    std::vector<ReportPicture> pictures;
    std::vector<ReportTable> tables;
    std::string note = {};  ///< under them
};

/// Everything that a report shows, in the order of the page. Empty parts are left out.
struct ReportContent {
    std::string title;
    std::vector<std::string> summary;  ///< one sentence per line
    std::vector<ReportPicture> pictures;
    std::vector<ReportSection> sections;  ///< after the pictures
    std::vector<KeyFigure> figures;
    std::vector<std::string> reasons;  ///< why something is missing or refused, in words
    std::vector<StageTiming> stages;
    std::vector<double> frame_ms;  ///< all stages of one frame
    double frame_limit_ms = 0.0;   ///< time between frames; 0 = none
    std::vector<HealthSample> health;
    std::string plots_title = "Errors";
    std::vector<ReportPlot> plots;
    std::string thumbnails_title = "Pictures";
    std::vector<ReportPicture> thumbnails;  ///< small, many in a row
    std::string details_title = "Counts";   ///< over bars and tables
    std::vector<ReportBars> bars;
    std::vector<ReportTable> tables;
    ReportTable configuration;  ///< what the run really used
    std::string footer;
};

/// Adds what the frames of a run tell: stage and frame times, health, where the points went, and
/// the table of the health reasons.
void add_frames(ReportContent& content, std::span<const FrameReport> frames);

/// One self-contained HTML page: pictures inside, no script, nothing from outside; light or dark as
/// the reader's system, and printable. All texts are escaped.
[[nodiscard]] std::string render_html(const ReportContent& content);

/// RFC 4648 with padding.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace surefoot::eval
