// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "service/console/writes.hpp"
#include "service/live/ground_box.hpp"
#include "studies/runs/run_features.hpp"
#include "studies/runs/stairs_json.hpp"
#include "studies/runs/stairs_text.hpp"
#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/eval/stairs/classes_picture.hpp"
#include "surefoot/eval/stairs/stairs_picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"

namespace surefoot::app {
namespace {

grid::Layer sigma_of(const grid::Layer& variance_m2, const grid::Layer& height_m) {
    grid::Layer sigma_m(variance_m2.width(), variance_m2.height());
    for (std::size_t i = 0; i < sigma_m.size(); ++i) {
        const bool known = !std::isnan(height_m.data()[i]);
        sigma_m.data()[i] = known ? std::sqrt(variance_m2.data()[i]) : std::nanf("");
    }
    return sigma_m;
}

void add_camera_pictures(const pipeline::Pipeline& pipeline, eval::ReportContent& content) {
    if (pipeline.depth().disparity_px.empty()) return;
    const double fb = pipeline.rig().depth_to_disparity_px_m();
    if (!pipeline.pair().left.empty()) {
        content.pictures.push_back(
            {"Last image of the left camera, rectified",
             eval::encode_png(eval::render_camera_image(pipeline.pair().left,
                                                        {"Left camera", "last full frame"}))});
    }
    content.pictures.push_back(
        {"Disparity and the depth that follows from it; grey: no match",
         eval::encode_png(eval::render_disparity(
             pipeline.depth().disparity_px, fb, {"Disparity", "last full frame"}))});
}

void add_sigma_pictures(const pipeline::Pipeline& pipeline,
                        const eval::Overlays& drawn,
                        eval::ReportContent& content) {
    const auto& layers = pipeline.map().layers();
    content.pictures.push_back({"Standard deviation of each height of the map",
                                eval::encode_png(eval::render_layer(
                                    pipeline.map().geometry(),
                                    sigma_of(layers.height_var_m2.copy(), layers.height_m.copy()),
                                    eval::height_sigma_style(),
                                    drawn))});
    if (pipeline.depth().sigma_px.empty()) return;
    content.pictures.push_back(
        {"Standard deviation of the disparity of each pixel, as the map uses it",
         eval::encode_png(eval::render_sigma(
             pipeline.depth().sigma_px, "px", {"Disparity sigma", "last full frame"}))});
}

void add_trajectory_picture(const RunRecord& record, eval::ReportContent& content) {
    const Trajectory truth = record.truth ? record.truth->truth_trajectory : Trajectory{};
    content.pictures.push_back({"Path of base_link",
                                eval::encode_png(eval::render_trajectory(
                                    trajectory_of(record.frames),
                                    truth,
                                    {"Trajectory of base_link", "odom, from above"}))});
}

void add_truth(const RunRecord& record,
               const pipeline::Pipeline& pipeline,
               const eval::Overlays& drawn,
               double safe_threshold,
               eval::ReportContent& content) {
    if (!record.truth) return;
    const TruthFigures& t = *record.truth;
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    content.pictures.push_back(
        {"Live height minus true height, without alignment",
         eval::encode_png(eval::render_error_map(
             geometry, t.maps.error_m, {"Height error", "live - truth"}, drawn))});
    content.pictures.push_back(
        {"Rating of the map compared with the rating of the true heights",
         eval::encode_png(eval::render_confusion(geometry,
                                                 t.maps.calls,
                                                 {"Safe or unsafe, compared with the truth",
                                                  fmt::format("threshold {:.2f}", safe_threshold)},
                                                 drawn))});
    content.figures.push_back(
        {"Elevation, median |error|",
         fmt::format("{:.1f}", 1e3 * t.maps.elevation.median_abs_m),
         "mm",
         "compared with the highest true surface of the cell; under an object in the map, with the "
         "true surface nearest to the map height"});
    content.figures.push_back({"Elevation, 90th percentile of |error|",
                               fmt::format("{:.1f}", 1e3 * t.maps.elevation.p90_abs_m),
                               "mm",
                               ""});
    content.figures.push_back(
        {"Height errors above 50 mm, away from edges",
         fmt::format("{:.2f}", 100.0 * t.maps.elevation_away_from_edges.share_over_50mm),
         "%",
         ""});
    content.figures.push_back({"Known share of the ground visible within 2.5 m",
                               fmt::format("{:.1f}", 100.0 * t.coverage_within_2_5_m),
                               "%",
                               ""});
    content.figures.push_back({"Trajectory error",
                               fmt::format("{:.1f}", 1e3 * t.trajectory.ate_rmse_m),
                               "mm rmse",
                               fmt::format("over {:.2f} m", t.trajectory.path_length_m)});
    content.figures.push_back(
        {"Depths within 3 sigma", fmt::format("{:.1f}", 100.0 * t.depth.within_3_sigma), "%", ""});
}

/// Returns the edges and stairs drawn over the heights, with their measures.
eval::ReportSection stairs_section(const pipeline::Pipeline& pipeline,
                                   const std::vector<std::uint8_t>& png,
                                   const std::vector<std::uint8_t>& classes_png) {
    eval::ReportSection section;
    section.title = "Edges and stairs";
    section.pictures.push_back(
        {"Ticks point to the lower ground; the steps are numbered in walking direction",
         png,
         true});
    section.pictures.push_back(
        {"Ground class of each cell; hatched: unknown or uncertain", classes_png, true});
    const RunFeatures features = split_by_confirmation(pipeline.features());
    section.tables.push_back(features_table(features.confirmed));
    section.note = features_count_text(features) + ".";
    if (const std::string note = gravity_note(pipeline.alignment().gravity_source); !note.empty())
        section.note += " " + note + ".";
    return section;
}

eval::ReportTable configuration_table(const Settings& settings) {
    eval::ReportTable table{"Configuration that the run used", {"key", "value", "meaning"}, {}};
    for (const auto& entry : io::list_config_of(settings))
        table.rows.push_back({entry.key, entry.value, entry.comment});
    return table;
}

/// Returns a text such as "mirror suspected at 0.45 m, bearing 3 deg to the left", seen from
/// base_link at the last frame.
std::string pane_text(const specular::SuspectedPane& pane,
                      double mirror_correlation,
                      const Pose& T_odom_body) {
    const Eigen::Vector3d normal_body =
        T_odom_body.rotation.conjugate() * Eigen::Vector3d(pane.normal.x(), pane.normal.y(), 0.0);
    const double bearing_deg =
        std::atan2(normal_body.y(), normal_body.x()) * 180.0 / std::numbers::pi;
    return fmt::format("{} suspected at {:.2f} m, bearing {:.0f} deg to the {}",
                       pane.correlation >= mirror_correlation ? "Mirror" : "Mirror or glass",
                       pane.offset_m - pane.normal.dot(T_odom_body.translation_m.head<2>()),
                       std::abs(bearing_deg),
                       bearing_deg < 0.0 ? "right" : "left");
}

std::vector<std::string> summary_lines(const RunRecord& record,
                                       const pipeline::Pipeline& pipeline) {
    std::vector<std::string> lines = {
        fmt::format("{} frames of {} ({}), {} map cells known.",
                    record.frames.size(),
                    record.source.path,
                    record.source.kind,
                    pipeline.map().known_cells()),
        fmt::format("Gravity and ground: {}.", pipeline.alignment().reason)};
    for (const specular::SuspectedPane& pane : pipeline.panes())
        lines.push_back(
            pane_text(pane, pipeline.config().specular.mirror_correlation, pipeline.T_odom_body()) +
            ": the gate treats the ground at it and behind it as unknown.");
    if (std::string note = modelled_note(record.source); !note.empty()) lines.push_back(note);
    for (const std::string& note : record.source.notes)
        lines.push_back(fmt::format("Note about the source: {}.", note));
    if (record.source.broken.count > 0) lines.push_back(broken_text(record.source.broken));
    lines.push_back(record.complete()
                        ? "The run is complete."
                        : fmt::format("The run ended early: {}", record.error->message));
    return lines;
}

}  // namespace

eval::Overlays overlays_of(const std::optional<io::MachineFile>& machine, const RunRecord& record) {
    eval::Overlays result;
    for (const FrameReport& frame : record.frames) {
        result.trajectory_m.emplace_back(frame.motion.T_odom_body.translation_m.head<2>());
    }
    if (record.frames.empty()) return result;
    result.T_odom_body = record.frames.back().motion.T_odom_body;
    if (machine) {
        for (const GroundBox* foot : {&machine->machine.left_foot, &machine->machine.right_foot}) {
            eval::Outline outline;
            outline.points_m = box_outline(*foot, *result.T_odom_body);
            outline.label = "feet";
            result.outlines.push_back(outline);
        }
    }
    return result;
}

Status write_pictures_and_report(const RunOptions& options,
                                 const Settings& settings,
                                 const std::optional<io::MachineFile>& machine,
                                 const pipeline::Pipeline& pipeline,
                                 const RunRecord& record) {
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    const grid::Layer height_m = pipeline.surface_m();
    const eval::Overlays drawn = overlays_of(machine, record);
    const auto elevation_png =
        eval::encode_png(eval::render_layer(geometry, height_m, eval::elevation_style(), drawn));
    const grid::Layer unknown(geometry.nx, geometry.ny, std::nanf(""));
    const grid::Layer& rating =
        pipeline.rating().traversability.empty() ? unknown : pipeline.rating().traversability;
    const auto rating_png = eval::encode_png(eval::render_layer(
        geometry, rating, eval::traversability_style(settings.maps.safe_threshold), drawn));
    const auto stairs_png = eval::encode_png(eval::render_features(
        geometry, height_m, pipeline.features(), drawn, {"Edges and stairs", "over the heights"}));

    const auto classes_png = eval::encode_png(eval::render_classes(
        geometry, height_m, pipeline.ground_classes(), drawn, {"Ground classes", "cell by cell"}));

    eval::ReportContent content;
    content.title = fmt::format("Surefoot: {}", record.source.path);
    content.summary = summary_lines(record, pipeline);
    content.pictures.push_back({"Height of the ground, from above", elevation_png});
    content.pictures.push_back({"Safe to step or not; hatched: unknown", rating_png});
    content.sections.push_back(stairs_section(pipeline, stairs_png, classes_png));
    add_camera_pictures(pipeline, content);
    add_sigma_pictures(pipeline, drawn, content);
    add_truth(record, pipeline, drawn, settings.maps.safe_threshold, content);
    add_trajectory_picture(record, content);
    if (const std::string reason = empty_map_reason(record, pipeline); !reason.empty()) {
        content.reasons.push_back("The map is empty: " + reason);
    }
    if (!record.complete()) content.reasons.push_back(record.error->message);
    eval::add_frames(content, record.frames);
    content.frame_limit_ms = record.rig.rate_hz > 0.0 ? 1e3 / record.rig.rate_hz : 0.0;
    content.configuration = configuration_table(settings);
    content.footer =
        fmt::format("surefoot {}; peak memory {:.0f} MB", SUREFOOT_VERSION, peak_memory_mb());

    Writes writes;
    writes += io::write_file(options.out_dir + "/elevation.png", elevation_png);
    writes += io::write_file(options.out_dir + "/traversability.png", rating_png);
    writes += io::write_file(options.out_dir + "/stairs.png", stairs_png);
    writes += io::write_file(options.out_dir + "/classes.png", classes_png);
    writes += io::write_file(options.out_dir + "/report.html", eval::render_html(content));
    return writes.first();
}

}  // namespace surefoot::app
