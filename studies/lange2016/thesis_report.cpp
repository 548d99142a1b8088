// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/sim/scenes/expression.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

const ThesisRun& run_named(std::string_view name) {
    for (const ThesisRun& run : thesis_runs()) {
        if (run.name == name) return run;
    }
    return thesis_runs().front();
}

double figure_of(const ThesisResults& results,
                 std::string_view run,
                 ThesisColumn column,
                 std::string_view figure) {
    const auto at = results.runs.find(std::string(run));
    if (at == results.runs.end()) return std::nan("");
    return at->second[static_cast<std::size_t>(column)].get(figure);
}

/// Returns a figure of a column. If the row has `divided_by`, divides the figure by that of the
/// other run.
double value_of(const ThesisResults& results, const ThesisRow& row, ThesisColumn column) {
    double value = std::nan("");
    if (column == ThesisColumn::ours && row.ours_figure != nullptr)
        value = figure_of(results, row.run, column, row.ours_figure);
    if (std::isnan(value)) value = figure_of(results, row.run, column, row.figure);
    if (std::string_view(row.divided_by).empty()) return value;
    return value / figure_of(results, row.divided_by, column, row.figure);
}

double exact_of(const ThesisRow& row, std::uint64_t seed) {
    if (std::string_view(row.truth).empty()) return std::nan("");
    const ThesisRun& run = run_named(row.run);
    const auto script = sim::make_scene(
        run.scene, seed, sim::motion_model_of(motion_model_choice(run.motion_model)));
    if (!script) return std::nan("");
    const auto value = sim::evaluate(row.truth, sim::drawn_numbers(*script));
    return value ? *value : std::nan("");
}

std::string shown(FigureKind kind, double value) {
    if (std::isnan(value)) return "-";
    switch (kind) {
        case FigureKind::count: return fmt::format("{:.0f}", value);
        case FigureKind::share: return fmt::format("{:.1f} %", 100.0 * value);
        case FigureKind::length_m: return fmt::format("{:.1f}", 1e3 * value);
        case FigureKind::percent:
        case FigureKind::pixels:
        case FigureKind::number: break;
    }
    return fmt::format("{:.2f}", value);
}

std::string heading_of(const ThesisRow& row) {
    return std::string(row.what) + (row.kind == FigureKind::length_m ? " [mm]" : "");
}

std::vector<eval::ReportPicture> pictures_of(const ThesisRun& run,
                                             const ThesisConditions& conditions) {
    const std::string ours = conditions.run_folder(run, ThesisColumn::ours);
    const std::string thesis = conditions.run_folder(run, ThesisColumn::thesis);
    const std::pair<std::string, std::string> files[] = {
        {ours + "/camera.png", "last camera image"},
        {ours + "/scan_elevation.png", "laser scan, in the same cells"},
        {ours + "/elevation.png", "Surefoot"},
        {thesis + "/elevation.png", "settings of the reference thesis"},
        {ours + "/scan_traversability.png", "laser scan, rated by the same filters"},
        {ours + "/traversability.png", "Surefoot"},
        {thesis + "/traversability.png", "settings of the reference thesis"},
        {ours + "/m3c2.png",
         "Surefoot: red = the truth is higher than the live map, blue = the truth is lower"},
        {thesis + "/m3c2.png", "settings of the reference thesis"},
        {ours + "/confusion.png", "Surefoot"},
        {thesis + "/confusion.png", "settings of the reference thesis"},
    };
    std::vector<eval::ReportPicture> pictures;
    for (const auto& [file, caption] : files) {
        const auto bytes = io::read_file(file);
        if (bytes) pictures.push_back({caption, {bytes->begin(), bytes->end()}});
    }
    return pictures;
}

eval::ReportTable rows_table(const std::vector<FilledRow>& rows, const std::string& group) {
    eval::ReportTable table;
    table.title = group;
    table.header = {
        "figure", "reference thesis", "thesis settings", "Surefoot", "laser scan", "exact"};
    table.wide = true;
    for (const FilledRow& filled : rows) {
        if (filled.row.group != group) continue;
        const FigureKind kind = filled.row.kind;
        table.rows.push_back({heading_of(filled.row),
                              filled.row.thesis,
                              shown(kind, filled.thesis_settings),
                              shown(kind, filled.ours),
                              shown(kind, filled.scan),
                              shown(kind, filled.exact)});
    }
    return table;
}

eval::ReportTable dataset_table(const std::vector<DatasetFigures>& datasets) {
    eval::ReportTable table;
    table.title = "The 13 sites of the reference thesis (Table 8.2), rebuilt as scenes";
    table.header = {"letter",
                    "reference thesis",
                    "size in the thesis [m]",
                    "million points in the thesis",
                    "scene",
                    "size of the scene [m]",
                    "objects",
                    "scanner stations",
                    "million points of the scene"};
    table.hint =
        "The number of points of a scene holds for a scan at full resolution. It is estimated from "
        "a coarse scan.";
    table.wide = true;
    for (const DatasetFigures& d : datasets) {
        table.rows.push_back({d.of.label,
                              fmt::format("{}: {}", d.of.project, d.of.features),
                              d.of.size,
                              fmt::format("{:.0f}", d.of.million_points),
                              d.of.scene,
                              fmt::format("{:.1f} x {:.1f}", d.length_m, d.width_m),
                              std::to_string(d.objects),
                              std::to_string(d.stations),
                              fmt::format("{:.0f}", 1e-6 * d.points)});
    }
    return table;
}

/// Returns the groups in the order of the rows.
std::vector<std::string> groups_of(const std::vector<FilledRow>& rows) {
    std::vector<std::string> groups;
    for (const FilledRow& filled : rows) {
        if (groups.empty() || groups.back() != filled.row.group)
            groups.emplace_back(filled.row.group);
    }
    return groups;
}

Json figures_json(const ThesisFigures& figures) {
    Json object = Json::object();
    for (const auto& [name, value] : figures.all()) {
        object[name] = number(value);
    }
    return object;
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c;
    }
    return out + '"';
}

}  // namespace

std::vector<FilledRow> filled_rows(const ThesisResults& results, std::uint64_t seed) {
    std::vector<FilledRow> rows;
    for (const ThesisRow& row : thesis_rows()) {
        if (!results.runs.contains(row.run)) continue;
        const auto scan = results.scans.find(run_named(row.run).scene);
        const bool ratio = !std::string_view(row.divided_by).empty();
        rows.push_back(
            {row,
             value_of(results, row, ThesisColumn::thesis),
             value_of(results, row, ThesisColumn::ours),
             scan == results.scans.end() || ratio ? std::nan("") : scan->second.get(row.figure),
             exact_of(row, seed)});
    }
    return rows;
}

std::string thesis_html(const ThesisResults& results, const ThesisConditions& conditions) {
    const std::vector<FilledRow> rows = filled_rows(results, conditions.seed);
    eval::ReportContent page;
    page.title = "The experiments of the reference thesis (Lange 2016), repeated";
    page.summary = {
        "We rebuilt the sites of M. Lange's thesis of 2016 at their size. A simulated laser "
        "scanner scans them. A simulated ZED with realistic noise crosses them on a trolley, on a "
        "walking REX, or in a hand.",
        "Live maps are aligned to the surfaces of the scan and compared by C2C and M3C2. The scan "
        "passes through the same filters as the map.",
        "The column 'thesis settings' shows this program with the error model, fusion and filters "
        "of the thesis. We did not rebuild the camera driver, the tracker and the code of the "
        "thesis. Both columns use the same depth and the same motion."};
    for (const ThesisRun& run : thesis_runs()) {
        if (!results.runs.contains(run.name)) continue;
        eval::ReportSection section;
        section.title = fmt::format("{} ({})", run.title, run.figures);
        section.pictures = pictures_of(run, conditions);
        page.sections.push_back(std::move(section));
    }
    eval::ReportSection courtyard;
    courtyard.title = "Rated ground truth of the courtyard (Fig. 9.14)";
    for (const char* name : {"elevation", "traversability"}) {
        const auto bytes =
            io::read_file(fmt::format("{}/{}.png", conditions.scan_folder(kThesisCourtyard), name));
        if (bytes) courtyard.pictures.push_back({name, {bytes->begin(), bytes->end()}});
    }
    if (!courtyard.pictures.empty()) page.sections.push_back(std::move(courtyard));
    for (const ThesisRun& run : thesis_runs()) {
        if (!run.stairs) continue;
        for (const ThesisColumn column : {ThesisColumn::ours, ThesisColumn::thesis}) {
            const auto svg = io::read_file(conditions.run_folder(run, column) + "/heights.svg");
            if (!svg || svg->empty()) continue;
            page.plots.push_back(
                {fmt::format("{}, {}",
                             run.title,
                             column == ThesisColumn::ours ? "Surefoot"
                                                          : "settings of the reference thesis"),
                 *svg});
        }
        const auto svg = io::read_file(conditions.scan_folder(run.scene) + "/heights.svg");
        if (svg && !svg->empty())
            page.plots.push_back({fmt::format("{}: laser scan", run.title), *svg});
    }
    page.plots_title = "Heights of the stairs";
    page.details_title = "Reference thesis, thesis settings, Surefoot, laser scan, exact";
    for (const std::string& group : groups_of(rows)) page.tables.push_back(rows_table(rows, group));
    page.tables.push_back(dataset_table(results.datasets));
    page.reasons = results.failures;
    return eval::render_html(page);
}

std::string thesis_json(const ThesisResults& results, const ThesisConditions& conditions) {
    Json rows = Json::array();
    for (const FilledRow& f : filled_rows(results, conditions.seed)) {
        rows.push_back({{"group", f.row.group},
                        {"what", f.row.what},
                        {"run", f.row.run},
                        {"figure", f.row.figure},
                        {"thesis", f.row.thesis},
                        {"length", f.row.kind == FigureKind::length_m},
                        {"ratio", !std::string_view(f.row.divided_by).empty()},
                        {"thesis_settings", number(f.thesis_settings)},
                        {"ours", number(f.ours)},
                        {"scan", number(f.scan)},
                        {"exact", number(f.exact)}});
    }
    Json runs = Json::object();
    for (const auto& [name, columns] : results.runs) {
        for (const ThesisColumn column : {ThesisColumn::ours, ThesisColumn::thesis}) {
            const auto i = static_cast<std::size_t>(column);
            runs[name][kThesisColumnNames[i]] = figures_json(columns[i]);
        }
    }
    Json scans = Json::object();
    for (const auto& [scene, figures] : results.scans) scans[scene] = figures_json(figures);
    Json datasets = Json::array();
    for (const DatasetFigures& d : results.datasets) {
        datasets.push_back({{"label", d.of.label},
                            {"project", d.of.project},
                            {"scene", d.of.scene},
                            {"thesis_size", d.of.size},
                            {"thesis_million_points", d.of.million_points},
                            {"length_m", d.length_m},
                            {"width_m", d.width_m},
                            {"objects", d.objects},
                            {"stations", d.stations},
                            {"points", d.points}});
    }
    return dump_indented(Json{{"seed", conditions.seed},
                              {"rows", rows},
                              {"runs", runs},
                              {"scans", scans},
                              {"courtyard", figures_json(results.courtyard)},
                              {"datasets", datasets},
                              {"failures", results.failures}});
}

std::string thesis_csv(const ThesisResults& results, const ThesisConditions& conditions) {
    std::string text = "group,what,run,figure,thesis,thesis_settings,ours,scan,exact\n";
    const auto value = [](double v) {
        return std::isnan(v) ? std::string() : fmt::format("{:.9g}", v);
    };
    for (const FilledRow& f : filled_rows(results, conditions.seed)) {
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n",
                            quoted(f.row.group),
                            quoted(f.row.what),
                            f.row.run,
                            f.row.figure,
                            quoted(f.row.thesis),
                            value(f.thesis_settings),
                            value(f.ours),
                            value(f.scan),
                            value(f.exact));
    }
    return text;
}

void print_thesis(const ThesisResults& results, const ThesisConditions& conditions) {
    const std::vector<FilledRow> rows = filled_rows(results, conditions.seed);
    for (const std::string& group : groups_of(rows)) {
        fmt::print("{}\n  {:<56}{:>32}{:>18}{:>10}{:>12}{:>10}\n",
                   group,
                   "",
                   "reference thesis",
                   "thesis settings",
                   "Surefoot",
                   "laser scan",
                   "exact");
        for (const FilledRow& f : rows) {
            if (f.row.group != group) continue;
            fmt::print("  {:<56}{:>32}{:>18}{:>10}{:>12}{:>10}\n",
                       heading_of(f.row),
                       f.row.thesis,
                       shown(f.row.kind, f.thesis_settings),
                       shown(f.row.kind, f.ours),
                       shown(f.row.kind, f.scan),
                       shown(f.row.kind, f.exact));
        }
    }
}

}  // namespace surefoot::app
