// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "cli/json/depth_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/board_calibration/board_accuracy.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/eval/depth/depth_design.hpp"
#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/eval/report/line_plot.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/stereo/confidence.hpp"

namespace surefoot::app {
namespace {

constexpr double kMmPerM = 1000.0;
/// The reference thesis (Lange 2016) measured a length of 50.0 mm on a board.
constexpr double kLength_mm = 50.0;
constexpr std::array kDesignRanges_m = {0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0};

using Rows = std::vector<std::vector<std::string>>;

std::string csv_of(const std::vector<std::string>& header, const Rows& rows) {
    std::string csv = fmt::format("{}\n", fmt::join(header, ","));
    for (const auto& row : rows) csv += fmt::format("{}\n", fmt::join(row, ","));
    return csv;
}

/// Prints a table; each column is as wide as its widest entry.
void print_table(const std::vector<std::string>& header, const Rows& rows) {
    std::vector<std::size_t> widths;
    for (std::size_t k = 0; k < header.size(); ++k) {
        widths.push_back(header[k].size());
        for (const auto& row : rows) widths.back() = std::max(widths.back(), row[k].size());
    }
    const auto print = [&](const std::vector<std::string>& row) {
        for (std::size_t k = 0; k < row.size(); ++k) fmt::print("{:>{}}  ", row[k], widths[k]);
        fmt::print("\n");
    };
    print(header);
    for (const auto& row : rows) print(row);
}

/// Writes the report page with its table and plots. Also writes the table and each plot to separate
/// files.
Status write_page(const std::string& folder,
                  const std::string& name,
                  eval::ReportContent content,
                  const std::vector<std::pair<std::string, eval::LinePlot>>& plots) {
    if (auto made = io::make_folder(folder); !made) return made;
    Writes writes;
    for (const auto& [file, plot] : plots) {
        const std::string svg = eval::line_plot_svg(plot);
        if (svg.empty()) continue;
        writes += io::write_file(io::join_path(folder, file), svg);
        content.plots.push_back({plot.title, svg});
    }
    const eval::ReportTable& table = content.tables.front();
    writes +=
        io::write_file(io::join_path(folder, name + ".csv"), csv_of(table.header, table.rows));
    writes += io::write_file(io::join_path(folder, name + ".html"), eval::render_html(content));
    return writes.first();
}

// ---- the board ----------------------------------------------------------------------------------

std::string mm(std::optional<double> value_m, const char* format = "{:.1f}") {
    return value_m ? fmt::format(fmt::runtime(format), kMmPerM * *value_m) : "-";
}

eval::ReportTable accuracy_table(const std::vector<DistanceAccuracy>& rows) {
    eval::ReportTable table;
    table.title = "Error by distance";
    table.header = {"distance_m",
                    "axial_mm",
                    "std_mm",
                    "scale_mm_of_50",
                    "density_percent",
                    "observations",
                    "thesis_axial_mm",
                    "thesis_std_mm"};
    table.hint =
        "Axial: measured minus true distance of the board on the optical axis. The program fits a "
        "plane to the measured points; the distance of this plane is the measured distance. Std: "
        "standard deviation of all depths about the plane. Scale: error of a 50 mm length on the "
        "board that follows from the depth error (computed, because the board has no marks). "
        "Thesis: absolute axial error and standard deviation in Table 4.1 of the reference thesis "
        "(Lange 2016), measured with commercial cameras.";
    for (const DistanceAccuracy& row : rows) {
        const auto& e = row.errors;
        const auto value = [&](double eval::BoardErrors::*figure) {
            return e ? std::optional<double>(*e.*figure) : std::nullopt;
        };
        const auto thesis = [&](double ThesisAccuracy::*figure) {
            return row.thesis ? std::optional<double>(*row.thesis.*figure) : std::nullopt;
        };
        table.rows.push_back({fmt::format("{:g}", row.distance_m),
                              mm(value(&eval::BoardErrors::axial_m), "{:+.2f}"),
                              mm(value(&eval::BoardErrors::std_m), "{:.2f}"),
                              e ? fmt::format("{:+.3f}", kLength_mm * e->scale_share) : "-",
                              fmt::format("{:.1f}", row.density_percent),
                              fmt::format("{}", row.observations),
                              mm(thesis(&ThesisAccuracy::axial_m)),
                              mm(thesis(&ThesisAccuracy::std_m))});
    }
    return table;
}

/// Plots our figures beside the figures of the cameras in the reference thesis (Lange 2016).
eval::LinePlot accuracy_plot(const std::string& rig,
                             const std::vector<DistanceAccuracy>& rows,
                             const char* title,
                             double eval::BoardErrors::*ours,
                             double ThesisAccuracy::*theirs) {
    eval::LinePlot plot{title, "distance of the board [m]", "mm", {{rig, {}}}};
    for (const DistanceAccuracy& row : rows) {
        const double value_m = row.errors ? std::abs(*row.errors.*ours) : std::nan("");
        plot.lines[0].points.push_back({row.distance_m, kMmPerM * value_m});
    }
    for (const ThesisAccuracy& value : thesis_accuracy()) {
        const std::string label = fmt::format("thesis, {}", value.camera);
        if (plot.lines.back().label != label) plot.lines.push_back({label, {}, true});
        plot.lines.back().points.push_back({value.distance_m, kMmPerM * (value.*theirs)});
    }
    return plot;
}

int measure_board(const DepthAccuracyOptions& options, const Settings& settings) {
    const auto rig = load_rig(options.rig);
    if (!rig) return report(rig.error());
    const auto executor = make_executor(options.common);
    const auto rows = measure_accuracy(options, settings, *rig, *executor);
    if (!rows) return report(rows.error());
    const std::string name = rig->name.empty() ? options.rig : rig->name;
    eval::ReportContent content;
    content.title = fmt::format("Depth accuracy of {}", name);
    content.summary = {
        options.pairs_file.empty()
            ? fmt::format("A flat textured square board with a side of {:g} m, rendered with the "
                          "camera profile '{}'; {} observations per distance.",
                          options.board_m,
                          sim::kCameraProfileNames[static_cast<int>(settings.sim.profile)],
                          options.repeats)
            : fmt::format(
                  "Real image pairs listed in {}; they show a square board with a side of {:g} m.",
                  options.pairs_file,
                  options.board_m),
        "The plots also show the measurements of the reference thesis (Lange 2016, Table 4.1) with "
        "commercial cameras."};
    content.plots_title = "Comparison with the reference thesis";
    content.tables = {accuracy_table(*rows)};
    if (auto written = write_page(options.out_dir,
                                  "depth_accuracy",
                                  content,
                                  {{"axial_error.svg",
                                    accuracy_plot(name,
                                                  *rows,
                                                  "Absolute axial error",
                                                  &eval::BoardErrors::axial_m,
                                                  &ThesisAccuracy::axial_m)},
                                   {"std.svg",
                                    accuracy_plot(name,
                                                  *rows,
                                                  "Standard deviation",
                                                  &eval::BoardErrors::std_m,
                                                  &ThesisAccuracy::std_m)}});
        !written) {
        return report(written.error());
    }
    if (options.common.json) {
        print_answer(depth_accuracy_json(name, *rows, options.out_dir));
    } else {
        print_table(content.tables[0].header, content.tables[0].rows);
    }
    return kExitOk;
}

// ---- design -------------------------------------------------------------------------------------

Result<eval::DepthDesign> design_of(const DepthAccuracyOptions& options, const Settings& settings) {
    const auto rig = load_rig(options.rig);
    if (!rig) return rig.error();
    const auto rectifier = camera::Rectifier::make(*rig, settings.pipeline.camera);
    if (!rectifier) return rectifier.error();
    const camera::RectifiedRig& ideal = rectifier->rig();
    eval::DepthDesign design{ideal.baseline_m,
                             ideal.fx_px,
                             ideal.width,
                             ideal.height,
                             static_cast<double>(stereo::kSigmaFloor_px),
                             options.height_m,
                             options.pitch_deg};
    if (options.baseline_m != 0.0) design.baseline_m = options.baseline_m;
    if (options.focal_px != 0.0) design.focal_px = options.focal_px;
    if (options.sigma_px != 0.0) design.sigma_px = options.sigma_px;
    if (!options.size.empty()) {
        int end = 0;
        const int found = std::sscanf(  // NOLINT(cert-err34-c): %n tells whether all was read
            options.size.c_str(),
            "%5dx%5d%n",
            &design.width,
            &design.height,
            &end);
        if (found != 2 || end != static_cast<int>(options.size.size()))
            return usage_error(fmt::format(
                "--size {} is not an image size; write WIDTHxHEIGHT in px, for example 672x376",
                options.size));
    }
    if (const auto problem = design.problem()) return usage_error(*problem);
    return design;
}

eval::ReportTable design_table(const std::vector<eval::ResolvableHeight>& rows) {
    eval::ReportTable table;
    table.title = "Smallest resolvable height by range";
    table.header = {"range_m",
                    "in_view",
                    "depth_m",
                    "sigma_depth_mm",
                    "noise_limit_mm",
                    "pixel_limit_mm",
                    "height_mm"};
    table.hint =
        "Symbols: Z = range along the floor, H = height of the camera, f = focal length, b = "
        "baseline, sigma_d = standard deviation of a disparity. Noise limit: 3 sigma of the "
        "difference of two heights, which is 3 sqrt(2) H Z sigma_d / (f b). It follows from "
        "sigma_Z = Z^2 sigma_d / (f b) (Matthies and Shafer 1987). Pixel limit: height that covers "
        "3 rows of the image. The resolvable height is the larger of the two limits. The figures "
        "hold for single pixels, without averaging.";
    for (const eval::ResolvableHeight& row : rows) {
        table.rows.push_back({fmt::format("{:g}", row.range_m),
                              row.in_view ? "yes" : "no",
                              fmt::format("{:.3f}", row.depth_m),
                              mm(row.sigma_depth_m, "{:.2f}"),
                              mm(row.noise_limit_m),
                              mm(row.pixel_limit_m),
                              mm(row.height_m)});
    }
    return table;
}

eval::LinePlot design_plot(const std::vector<eval::ResolvableHeight>& rows) {
    eval::LinePlot plot{"Smallest resolvable height",
                        "range along the floor [m]",
                        "mm",
                        {{"resolvable", {}}, {"noise limit", {}, true}, {"pixel limit", {}, true}}};
    for (const eval::ResolvableHeight& row : rows) {
        const auto seen = [&](double value_m) {
            return eval::LinePlot::Point{row.range_m,
                                         row.in_view ? kMmPerM * value_m : std::nan("")};
        };
        plot.lines[0].points.push_back(seen(row.height_m));
        plot.lines[1].points.push_back(seen(row.noise_limit_m));
        plot.lines[2].points.push_back(seen(row.pixel_limit_m));
    }
    return plot;
}

int show_design(const DepthAccuracyOptions& options, const Settings& settings) {
    const auto design = design_of(options, settings);
    if (!design) return report(design.error());
    std::vector<double> ranges_m = options.distances_m;
    if (ranges_m.empty()) ranges_m.assign(kDesignRanges_m.begin(), kDesignRanges_m.end());
    std::vector<eval::ResolvableHeight> rows;
    rows.reserve(ranges_m.size());
    for (const double range_m : ranges_m) rows.push_back(eval::resolvable_height(*design, range_m));
    eval::ReportContent content;
    content.title = "Smallest height difference that a stereo camera resolves";
    content.summary = {fmt::format("Baseline {:g} m, focal length {:g} px, images of {}x{} px, "
                                   "standard deviation of a disparity {:g} px. The camera is {:g} "
                                   "m above the floor and looks {:g} deg below the horizon.",
                                   design->baseline_m,
                                   design->focal_px,
                                   design->width,
                                   design->height,
                                   design->sigma_px,
                                   design->camera_height_m,
                                   design->pitch_deg),
                       fmt::format("The nearest visible floor is {:.2f} m ahead.",
                                   eval::nearest_floor_m(*design))};
    content.plots_title = "By range";
    content.tables = {design_table(rows)};
    if (auto written = write_page(options.out_dir,
                                  "depth_design",
                                  content,
                                  {{"resolvable_height.svg", design_plot(rows)}});
        !written) {
        return report(written.error());
    }
    if (options.common.json) {
        print_answer(depth_design_json(*design, rows, options.out_dir));
    } else {
        for (const std::string& line : content.summary) fmt::print("{}\n", line);
        print_table(content.tables[0].header, content.tables[0].rows);
    }
    return kExitOk;
}

/// `surefoot depth-accuracy`: measures the depth error by distance on a flat textured board. With
/// --design, computes the smallest step height that a rig resolves.
int depth_accuracy(const DepthAccuracyOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    return options.design ? show_design(options, *settings) : measure_board(options, *settings);
}

}  // namespace

void add_depth_accuracy(VerbGroup verbs) {
    auto [verb, o] = verbs.add<DepthAccuracyOptions>(
        "depth-accuracy",
        "measure the depth error by distance on a flat textured board; with --design, compute the "
        "smallest step that a rig resolves",
        "surefoot depth-accuracy --rig zed_vga --distances 1,2 --repeats 1 --set "
        "sim.profile=zed --out out/accuracy\n"
        "  surefoot depth-accuracy --design --baseline 0.12 --focal 342 --size "
        "672x376 --out out/design",
        depth_accuracy);
    const Option rig =
        verb.option("--rig", o.rig, "calibration file, or name of a built-in rig (default zed_vga)")
            .value("FILE|NAME");
    verb.option("--out", o.out_dir, "folder for the report page, its plots and its table")
        .required()
        .value("DIR");
    const Option distances = verb.option("--distances",
                                         o.distances_m,
                                         "distances from the camera to the board, in m, separated "
                                         "by commas; with --design, ranges along the floor")
                                 .separated_by_commas()
                                 .in(0.1, 20.0)
                                 .value("M");
    verb.option("--repeats", o.repeats, "number of rendered boards per distance (default 3)")
        .in(1, 1000);
    verb.option("--board",
                o.board_m,
                "side of the square board, in m (default 0.6); only the inner 80 % of the board "
                "are evaluated")
        .in(0.05, 4.0)
        .value("M");
    const Option pairs =
        verb.option("--pairs",
                    o.pairs_file,
                    "file that lists real image pairs, to use instead of rendered images. Each "
                    "line is LEFT RIGHT DISTANCE_M: two image files and the distance in m. The "
                    "board must stand perpendicular to the optical axis")
            .value("FILE")
            .needs(rig)
            .excludes(distances);
    const Option design =
        verb.flag("--design",
                  o.design,
                  "compute the smallest height difference that the rig resolves at each range; "
                  "needs no images. --baseline, --focal and --size change the rig");
    design.excludes(pairs);
    verb.option("--baseline",
                o.baseline_m,
                "with --design: distance between the two cameras, in m (default: the baseline of "
                "--rig)")
        .value("M")
        .needs(design);
    verb.option("--focal",
                o.focal_px,
                "with --design: focal length of the rectified images, in px (default: the focal "
                "length of --rig)")
        .value("PX")
        .needs(design);
    verb.option(
            "--size", o.size, "with --design: image size, in px (default: the image size of --rig)")
        .value("WIDTHxHEIGHT")
        .needs(design);
    const std::string sigma_help = fmt::format(
        "with --design: standard deviation of a disparity, in px (default: {:.3f}, the lower limit "
        "of the matcher of Surefoot)",
        stereo::kSigmaFloor_px);
    verb.option("--sigma", o.sigma_px, sigma_help.c_str()).value("PX").needs(design);
    verb.option("--height",
                o.height_m,
                "with --design: height of the camera above the floor, in m (default 1)")
        .value("M")
        .needs(design);
    verb.option("--pitch",
                o.pitch_deg,
                "with --design: angle of the camera below the horizon, in deg (default 32)")
        .value("DEG")
        .needs(design);
}

}  // namespace surefoot::app
