// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "studies/suite/suite_answers.hpp"
#include "studies/suite/suite_rows.hpp"
#include "studies/suite/suite_table.hpp"
#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

constexpr double kMillimetres = 1e3;

std::string shown(FigureKind kind, double value) {
    if (std::isnan(value)) return "-";
    switch (kind) {
        case FigureKind::count: return fmt::format("{:.0f}", value);
        case FigureKind::share: return fmt::format("{:.1f} %", 100.0 * value);
        case FigureKind::length_m: return fmt::format("{:.1f}", kMillimetres * value);
        case FigureKind::percent: return fmt::format("{:.2f} %", value);
        case FigureKind::pixels:
        case FigureKind::number: return fmt::format("{:.3f}", value);
    }
    return "-";
}

std::string unit_of(FigureKind kind) {
    switch (kind) {
        case FigureKind::length_m: return " [mm]";
        case FigureKind::pixels: return " [px]";
        case FigureKind::count:
        case FigureKind::share:
        case FigureKind::percent:
        case FigureKind::number: break;
    }
    return "";
}

std::string heading_of(const SuiteFigure& figure) {
    return figure.meaning + unit_of(figure.kind);
}

std::string times(double noise) {
    return fmt::format("x {:g}", noise);
}

/// Returns the median over the cases of a row, and the worst value if there are several cases.
std::string median_and_worst(const SuiteRow& row, std::size_t figure) {
    const FigureKind kind = suite_figures()[figure].kind;
    const std::string median = shown(kind, row.median[figure]);
    const std::string worst = shown(kind, row.worst[figure]);
    return row.cases < 2 || worst == median ? median : fmt::format("{} ({})", median, worst);
}

// ---- the sums -----------------------------------------------------------------------------------

/// Returns the sum of a counted figure over all cases.
double sum_of(std::span<const SuiteResult> results, std::string_view name) {
    double sum = 0.0;
    for (const SuiteResult& result : results) {
        const double value = result.figure(name);
        if (!std::isnan(value)) sum += value;
    }
    return sum;
}

void add_key_figures(std::span<const SuiteResult> results, eval::ReportContent& content) {
    const double missed = sum_of(results, "missed_hazards");
    content.figures.push_back(
        {"Hazards missed by the gate",
         fmt::format("{:.0f}", missed),
         "",
         fmt::format(
             "of {:.0f} clear-cut questions; {:.0f} more missed hazards are dangerous by less than "
             "the margin of the oracle",
             sum_of(results, "questions"),
             sum_of(results, "borderline_missed"))});
    const double allowed = allowed_share(results, TallyKey::reason);
    for (const NoiseBins& level : pooled_by_noise(results)) {
        std::vector<SuiteResult> of_level;
        std::copy_if(results.begin(),
                     results.end(),
                     std::back_inserter(of_level),
                     [&](const SuiteResult& r) { return r.which.noise == level.noise; });
        content.figures.push_back(
            {fmt::format("Clearly safe movements allowed, noise {}", times(level.noise)),
             shown(FigureKind::share, allowed_share(of_level, TallyKey::reason)),
             "",
             fmt::format("of {:.0f} movements; the reasons of the refusals are listed below",
                         sum_of(of_level, "safe_questions"))});
        content.figures.push_back(
            {fmt::format("Clearly safe and seen movements allowed, noise {}", times(level.noise)),
             shown(FigureKind::share, allowed_share(of_level, TallyKey::seen)),
             "",
             fmt::format("of {:.0f} movements whose feet, ways and drop bands both cameras saw",
                         sum_of(of_level, "seen_questions"))});
    }
    if (allowed == 0.0) {
        content.reasons.push_back(
            "The gate allowed no movement in these runs, so the number of missed hazards says "
            "nothing yet. In a short run the camera has often not seen the ground around the "
            "feet.");
    }
    if (const double steps = sum_of(results, "steps"); steps > 0.0) {
        content.figures.push_back(
            {"Dangerous steps allowed",
             fmt::format("{:.0f}", sum_of(results, "steps_missed")),
             "",
             fmt::format("of {:.0f} steps that walking users asked for", steps)});
    }
    for (const NoiseBins& level : pooled_by_noise(results)) {
        eval::ErrorHistogram all;
        for (const SuiteBin& bin : level.bins) {
            if (bin.key == BinKey::range) all += bin.errors;
        }
        if (all.count() == 0) continue;
        content.figures.push_back({fmt::format("Height errors, noise {}", times(level.noise)),
                                   fmt::format("{:.1f}", kMillimetres * all.percentile(0.5)),
                                   "mm",
                                   fmt::format("median; 90 % are smaller than {:.0f} mm; {} cases",
                                               kMillimetres * all.percentile(0.9),
                                               level.cases)});
    }
}

eval::ReportTable motion_model_table(std::span<const SuiteResult> results) {
    static constexpr const char* kShown[] = {"healthy",
                                             "ate_rmse_m",
                                             "height_median_m",
                                             "height_p90_m",
                                             "coverage",
                                             "false_safe",
                                             "missed_hazards",
                                             "allowed",
                                             "allowed_of_seen",
                                             "steps_missed",
                                             "steps_allowed",
                                             "steps_allowed_of_seen"};
    eval::ReportTable table;
    table.title = "Figures by motion model";
    table.hint = "Median of all cases; the worst value in brackets.";
    table.wide = true;
    table.header = {"motion model", "noise", "cases"};
    std::vector<std::size_t> columns;
    for (const char* name : kShown) {
        const auto& all = suite_figures();
        const auto at = std::find_if(all.begin(), all.end(), [&](const SuiteFigure& f) {
            return f.name == std::string(name);
        });
        columns.push_back(static_cast<std::size_t>(at - all.begin()));
        table.header.push_back(heading_of(*at));
    }
    for (const SuiteRow& row : summarise_by_motion_model(results)) {
        std::vector<std::string> words = {
            row.motion_model, times(row.noise), std::to_string(row.cases)};
        for (const std::size_t column : columns) words.push_back(median_and_worst(row, column));
        table.rows.push_back(std::move(words));
    }
    return table;
}

// ---- errors by distance and image column --------------------------------------------------------

struct BinView {
    BinKey key;
    const char* title;
    const char* x_label;
    double tail;  ///< percentile (0 to 1) that the plot shows besides the median
    const char* tail_label;
};
constexpr BinView kBinViews[] = {
    {BinKey::range,
     "Height error by distance",
     "distance of the cell from the camera at its last observation [m]",
     0.9,
     "90 % are smaller"},
    {BinKey::column,
     "Height error by image column",
     "image column of the cell at its last observation [px]",
     0.9,
     "90 % are smaller"},
    {BinKey::jump_column,
     "Height steps between neighbouring cells of level floor",
     "image column of the cells at their last observation [px]",
     0.99,
     "99 % are smaller"},
};

std::vector<SuiteBin> of_key(const NoiseBins& level, BinKey key, std::int64_t fewest = 1) {
    std::vector<SuiteBin> bins;
    for (const SuiteBin& bin : level.bins) {
        if (bin.key == key && bin.errors.count() >= fewest) bins.push_back(bin);
    }
    return bins;
}
/// Smallest number of errors in a bin of a plot, because percentiles of fewer errors mean little.
/// The tables show all bins.
constexpr std::int64_t kFewestCells = 100;

/// Returns the largest value over all noise levels plus 10 %, so that the plots of all noise levels
/// share one scale.
double tallest_mm(std::span<const NoiseBins> levels, const BinView& view) {
    double tallest = 0.0;
    for (const NoiseBins& level : levels) {
        for (const SuiteBin& bin : of_key(level, view.key, kFewestCells))
            tallest = std::max(tallest, kMillimetres * bin.errors.percentile(view.tail));
    }
    return 1.1 * tallest;
}

eval::ReportPlot bin_plot(const NoiseBins& level, const BinView& view, double high_mm) {
    const std::vector<SuiteBin> bins = of_key(level, view.key, kFewestCells);
    if (bins.empty()) return {};
    eval::BinPlot plot;
    plot.edges = {bins.front().from};
    plot.x_label = view.x_label;
    plot.unit = "mm";
    plot.high = high_mm;
    plot.lines = {{"median", {}}, {view.tail_label, {}}};
    const auto append = [&](double to, double median_mm, double tail_mm) {
        plot.edges.push_back(to);
        plot.lines[0].values.push_back(median_mm);
        plot.lines[1].values.push_back(tail_mm);
    };
    for (const SuiteBin& bin : bins) {
        const double none = std::nan("");
        if (bin.from > plot.edges.back())
            append(bin.from, none, none);  // gap in the plot: bins without any error
        append(bin.to,
               kMillimetres * bin.errors.percentile(0.5),
               kMillimetres * bin.errors.percentile(view.tail));
    }
    return {fmt::format("{}, noise {}", view.title, times(level.noise)),
            eval::bin_plot_svg(plot),
            fmt::format("All scenes, {} cases. The plot shows only bins with {} cells or more.",
                        level.cases,
                        kFewestCells)};
}

eval::ReportTable bin_table(std::span<const NoiseBins> levels, const BinView& view) {
    eval::ReportTable table;
    table.title = fmt::format("{} [{}]", view.title, unit_of(view.key));
    table.header = {"noise",
                    "from",
                    "to",
                    "cells",
                    "median [mm]",
                    "90th percentile [mm]",
                    "99th percentile [mm]"};
    for (const NoiseBins& level : levels) {
        for (const SuiteBin& bin : of_key(level, view.key)) {
            const auto percentile = [&](double fraction) {
                return fmt::format("{:.1f}", kMillimetres * bin.errors.percentile(fraction));
            };
            table.rows.push_back({times(level.noise),
                                  fmt::format("{:g}", bin.from),
                                  fmt::format("{:g}", bin.to),
                                  std::to_string(bin.errors.count()),
                                  percentile(0.5),
                                  percentile(0.9),
                                  percentile(0.99)});
        }
    }
    table.folded = true;
    return table;
}

// ---- scene by scene -----------------------------------------------------------------------------

std::vector<eval::ReportTable> group_tables(std::span<const SuiteRow> rows) {
    std::vector<eval::ReportTable> tables;
    const auto& all = suite_figures();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (tables.empty() || tables.back().title != all[i].group) {
            eval::ReportTable table;
            table.title = all[i].group;
            table.header = {"scene", "motion model", "noise", "cases"};
            table.hint = "Median of the seeds; the worst value in brackets.";
            table.wide = true;
            for (const SuiteRow& row : rows) {
                table.rows.push_back(
                    {row.scene, row.motion_model, times(row.noise), std::to_string(row.cases)});
            }
            tables.push_back(std::move(table));
        }
        tables.back().header.push_back(heading_of(all[i]));
        for (std::size_t k = 0; k < rows.size(); ++k)
            tables.back().rows[k].push_back(median_and_worst(rows[k], i));
    }
    return tables;
}

eval::ReportTable case_table(std::span<const SuiteResult> results) {
    eval::ReportTable table;
    table.title = "Every case";
    table.wide = true;
    table.folded = true;
    table.header = {"case", "motion model"};
    for (const SuiteFigure& figure : suite_figures()) table.header.push_back(heading_of(figure));
    for (const SuiteResult& result : results) {
        std::vector<std::string> row = {result.which.name(), result.which.motion_model};
        for (std::size_t i = 0; i < suite_figures().size(); ++i)
            row.push_back(shown(suite_figures()[i].kind, result.figures[i]));
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// Adds the worst case of each scene, the worst scene first.
void add_thumbnails(std::span<const SuiteResult> results,
                    const std::string& folder,
                    eval::ReportContent& content) {
    std::map<std::string, const SuiteResult*> worst;
    for (const SuiteResult& result : results) {
        const SuiteResult*& known = worst[result.which.scene];
        if (known == nullptr || is_worse(result, *known)) known = &result;
    }
    std::vector<const SuiteResult*> shown_cases;
    shown_cases.reserve(worst.size());
    for (const auto& [scene, result] : worst) shown_cases.push_back(result);
    std::sort(shown_cases.begin(), shown_cases.end(), [](const auto* a, const auto* b) {
        return is_worse(*a, *b);
    });
    for (const SuiteResult* result : shown_cases) {
        const std::string path = thumbnail_file(folder, result->which.scene);
        if (!io::is_file(path)) continue;
        const auto png = io::read_file(path);
        if (!png) continue;
        content.thumbnails.push_back(
            {fmt::format(
                 "{}, seed {}, noise {}: {} of the truly unsafe cells called safe, {} of the truly "
                 "safe cells called unsafe; {:.0f} hazards missed",
                 result->which.scene,
                 result->which.seed,
                 times(result->which.noise),
                 shown(FigureKind::share, result->figure("false_safe")),
                 shown(FigureKind::share, result->figure("false_unsafe")),
                 result->figure("missed_hazards")),
             {png->begin(), png->end()}});
    }
}

}  // namespace

std::string suite_html(std::span<const SuiteResult> results, const std::string& folder) {
    const std::vector<SuiteRow> rows = summarise(results);
    const std::vector<NoiseBins> levels = pooled_by_noise(results);
    eval::ReportContent content;
    content.title = "Surefoot compared with the truth";
    content.summary = {
        fmt::format("{} simulated runs of the whole chain, in {} rows of scene, motion model and "
                    "noise. The maps are not aligned to the truth before the comparison.",
                    results.size(),
                    rows.size()),
        "docs/evidence/safety.md names the seeds that were used during development.",
        eval::kConfusionLegend};
    add_key_figures(results, content);
    content.plots_title = "Size and position of the map errors";
    for (const BinView& view : kBinViews) {
        for (const NoiseBins& level : levels)
            content.plots.push_back(bin_plot(level, view, tallest_mm(levels, view)));
    }
    content.thumbnails_title = "Safe or unsafe: the worst case of each scene";
    add_thumbnails(results, folder, content);
    content.details_title = "Figures";
    for (eval::ReportBars& bars : refusal_bars(results)) content.bars.push_back(std::move(bars));
    content.bars.push_back(step_bars(results));
    content.tables.push_back(motion_model_table(results));
    for (const TallyKey by : {TallyKey::seen, TallyKey::reason})
        content.tables.push_back(refusal_table(results, by));
    for (eval::ReportTable& table : group_tables(rows)) content.tables.push_back(std::move(table));
    for (const BinView& view : kBinViews) content.tables.push_back(bin_table(levels, view));
    content.tables.push_back(step_table(results));
    content.tables.push_back(case_table(results));
    content.footer = fmt::format("surefoot {}", SUREFOOT_VERSION);
    return eval::render_html(content);
}

}  // namespace surefoot::app
