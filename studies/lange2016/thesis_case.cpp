// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/lange2016/thesis_policy_steps.hpp"
#include "studies/lange2016/thesis_truth.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/eval/maps/shown_part.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/sim/scenes/expression.hpp"

namespace surefoot::app {
namespace {

/// Scanned distance around the path [m]: half a map length plus a margin for the alignment.
constexpr double kAround_m = 3.2;

Result<GroundBox> box_of(const BoxText& text, const sim::NamedNumbers& numbers) {
    double value_m[4];
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto value = sim::evaluate(text[i], numbers);
        if (!value) return value.error();
        value_m[i] = *value;
    }
    return GroundBox{{value_m[0], value_m[1]}, {value_m[2], value_m[3]}};
}

Result<sim::ScriptedScene> script_of(const ThesisRun& run, const ThesisConditions& conditions) {
    return sim::make_scene(
        run.scene, conditions.seed, sim::motion_model_of(motion_model_choice(run.motion_model)));
}

/// Takes the measurements of the thesis from a scan or a map. `points_m` supply vertical faces;
/// `map` supplies the ground.
Status measure_by_hand(const ThesisRun& run,
                       const sim::NamedNumbers& numbers,
                       std::span<const Eigen::Vector3f> points_m,
                       const RatedMap& map,
                       ThesisFigures& figures) {
    if (run.stairs) {
        const auto box = box_of(*run.stairs, numbers);
        if (!box) return box.error();
        measure_stairs(points_m, *box, figures);
    }
    if (run.door) {
        const Eigen::Vector2d door_m(numbers.at("door_x_m"), numbers.at("door_y_m"));
        measure_door(points_m, map, door_m, figures);
    }
    return {};
}

std::string as_text(const eval::Picture& picture) {
    const auto png = eval::encode_png(picture);
    return {png.begin(), png.end()};
}

eval::LayerStyle heights_style(const std::string& title, const eval::ValueRange& range) {
    eval::LayerStyle style = eval::elevation_style();
    style.text = {title, ""};
    style.range = range;
    return style;
}

eval::LayerStyle rating_style(const std::string& title, double safe_threshold) {
    eval::LayerStyle style = eval::traversability_style(safe_threshold);
    style.text = {title, ""};
    return style;
}

/// Writes pictures of the scan and of the live map with the same colours. They show only the part
/// that the live map knows.
Status write_pictures(const std::string& folder,
                      const RatedMap& truth,
                      const ComparedMap& compared,
                      const eval::Overlays& overlays,
                      double safe_threshold) {
    const eval::ShownPart part = eval::shown_part(truth.geometry, compared.live.height_m, overlays);
    const auto cut = [&](const grid::Layer& layer) { return part.of(layer, std::nanf("")); };
    const grid::Layer truth_m = cut(truth.height_m);
    const eval::ValueRange range = eval::shown_range(truth_m, eval::elevation_style());
    const auto write = [&](const char* name, const eval::Picture& picture) {
        return io::write_file(fmt::format("{}/{}.png", folder, name), as_text(picture));
    };
    const auto layer = [&](const grid::Layer& values, const eval::LayerStyle& style) {
        return eval::render_layer(part.geometry, values, style, overlays);
    };
    Writes writes;
    writes += write("scan_elevation", layer(truth_m, heights_style("Laser scan: heights", range)));
    writes += write("scan_traversability",
                    layer(cut(truth.traversability),
                          rating_style("Laser scan: traversability", safe_threshold)));
    writes += write("elevation",
                    layer(cut(compared.live.height_m), heights_style("Live map: heights", range)));
    writes += write("traversability",
                    layer(cut(compared.live.traversability),
                          rating_style("Live map: traversability", safe_threshold)));
    writes += write("m3c2",
                    eval::render_error_map(part.geometry,
                                           cut(compared.m3c2_m),
                                           {"Live map compared with the scan (M3C2, vertical)", ""},
                                           overlays));
    writes += write("confusion",
                    eval::render_confusion(part.geometry,
                                           part.of(compared.calls, eval::Call::no_truth),
                                           {"Traversability compared with the scan", ""},
                                           overlays));
    return writes.first();
}

grid::Layer lifted(const Image<float>& height_m, double by_m) {
    grid::Layer out = height_m;
    for (std::size_t i = 0; i < out.size(); ++i) out.data()[i] += static_cast<float>(by_m);
    return out;
}

/// Returns the live map with heights in the world frame.
RatedMap ground_surface(const pipeline::Pipeline& pipeline, double odom_z_m) {
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    return {geometry,
            lifted(pipeline.map().layers().height_m.copy(), odom_z_m),
            or_unknown(pipeline.rating().traversability, geometry)};
}

/// Returns the live map in the form of the scan and of the map of the thesis. Under an overhang
/// these contain the underside of the overhang instead of the ground. These heights are rated like
/// all other heights.
RatedMap highest_surfaces(const pipeline::Pipeline& pipeline, double odom_z_m) {
    grid::Layer height_m = lifted(pipeline.map().layers().height_m.copy(), odom_z_m);
    const grid::Layer clearance_m = pipeline.map().layers().clearance_m.copy();
    for (std::size_t i = 0; i < height_m.size(); ++i) {
        if (!std::isnan(clearance_m.data()[i])) height_m.data()[i] += clearance_m.data()[i];
    }
    return rated_map(pipeline.map().geometry(), height_m, pipeline.config().traversability);
}

/// Adds figures of the terrain features that the pipeline found, as `surefoot stairs` reports them.
void add_found(const pipeline::Pipeline& pipeline,
               const ThesisRun& run,
               const sim::NamedNumbers& numbers,
               ThesisFigures& figures) {
    const stairs::TerrainFeatures& found = pipeline.features();
    const auto most = std::max_element(
        found.flights.begin(), found.flights.end(), [](const auto& a, const auto& b) {
            return a.steps < b.steps;
        });
    const bool any = most != found.flights.end();
    const auto set = [&](const char* name, double value) {
        figures.set(name, any ? value : std::nan(""));
    };
    const stairs::Flight none;
    const stairs::Flight& flight = any ? *most : none;
    set("flight_steps", flight.steps);
    set("flight_riser_m", flight.riser_m);
    set("flight_riser_se_m", flight.riser_sigma_m);
    set("flight_riser_spread_m", flight.riser_spread_m);
    set("flight_going_m", flight.going_m);
    set("flight_first_riser_m",
        flight.edges.empty() ? std::nan("") : flight.edges.front().height_m());
    int steps = 0;
    for (const stairs::Flight& one : found.flights) steps += one.steps;
    figures.set("steps_found", steps);
    if (!run.stairs || !numbers.contains("stair_x_m")) return;
    // Distance of the nearest edge from the true position of the first edge.
    double off_m = std::nan("");
    for (const stairs::Edge& edge : found.edges) {
        const Eigen::Vector2d middle_m = edge.middle_m();
        if (std::abs(edge.along().x()) > 0.5) continue;  // only edges across the path count
        const double here_m = middle_m.x() - numbers.at("stair_x_m");
        if (std::isnan(off_m) || std::abs(here_m) < std::abs(off_m)) off_m = here_m;
    }
    figures.set("drop_off_m", std::abs(off_m));
}

/// A run of the pipeline on a recording that is simulated during the run.
class LiveRun {
  public:
    LiveRun(const ThesisRun& run,
            ThesisColumn column,
            const ThesisConditions& conditions,
            const Settings& settings)
        : run_(run), column_(column), conditions_(conditions), settings_(settings) {}

    [[nodiscard]] Status open() {
        SourceRequest request{
            run_.scene, "", run_.rate_hz, conditions_.max_frames, conditions_.seed, settings_.sim};
        request.sim.motion_model = motion_model_choice(run_.motion_model);
        auto source = open_simulation(request, serial_);
        if (!source) return source.error();
        source_ = std::move(*source);
        auto pipeline = pipeline::Pipeline::make(
            config_on(source_->truth(), settings_), source_->rig(), serial_, steady_now_ns);
        if (!pipeline) return pipeline.error();
        pipeline_.emplace(std::move(*pipeline));
        return {};
    }

    [[nodiscard]] Result<ThesisFigures> finish(const sim::NamedNumbers& numbers) {
        const std::string folder = conditions_.run_folder(run_, column_);
        if (auto status = io::make_folder(folder); !status) return status.error();
        PolicySteps steps(source_->truth(), conditions_.machine);
        RunSession session(*pipeline_, *source_, source_->rig(), 1, settings_.maps);
        session.drive("", [&](const FrameReport& frame) {
            if (run_.walk) ask_steps(frame, steps);
        });
        const RunRecord& record = session.record();
        if (record.error) return *record.error;
        if (pipeline_->map().known_cells() == 0)
            return input_error(fmt::format("{}: the map of the run is empty", run_.name));
        const auto scan =
            io::read_esri_grid(conditions_.scan_folder(run_.scene) + "/elevation.asc");
        if (!scan) return scan.error();
        const RatedMap truth =
            rated_map(scan->geometry, scan->values, settings_.pipeline.traversability);
        const double odom_z_m = odom_height_m(*pipeline_, source_->truth(), record.frames);
        const RatedMap live = highest_surfaces(*pipeline_, odom_z_m);
        ComparedMap compared = compare_with_scan(live, truth, settings_.m3c2, settings_.maps);
        ThesisFigures figures = std::move(compared.figures);
        add_record(record, figures);
        const RatedMap ground =
            laid_onto(truth, ground_surface(*pipeline_, odom_z_m), compared.T_truth_live);
        if (auto status = measure_by_hand(run_, numbers, cell_points_m(ground), ground, figures);
            !status)
            return status.error();
        add_found(*pipeline_, run_, numbers, figures);
        if (run_.walk) {
            if (auto status = take_snapshot(); !status) return status.error();
            steps.ask_all(
                static_cast<std::size_t>(record.frames.back().index), *pipeline_, *snapshot_);
            steps.add_to(column_ == ThesisColumn::ours, figures);
        }
        if (auto status = write_all(folder, record, truth, compared, ground, numbers); !status)
            return status.error();
        return figures;
    }

  private:
    [[nodiscard]] Status take_snapshot() {
        return pipeline_->snapshot(hash_of(settings_), *snapshot_);
    }
    void ask_steps(const FrameReport& frame, PolicySteps& steps) {
        while (steps.due(frame.time_ns)) {
            // If the snapshot fails, it is not intact and the gate refuses it.
            [[maybe_unused]] const Status taken = take_snapshot();
            steps.ask(*pipeline_, *snapshot_);
        }
    }

    static void add_record(const RunRecord& record, ThesisFigures& figures) {
        const auto healthy =
            std::count_if(record.frames.begin(), record.frames.end(), [](const FrameReport& frame) {
                return frame.motion.health == Health::ok;
            });
        std::vector<double> update_ms;
        for (const FrameReport& frame : record.frames) {
            if (frame.work != Work::full) continue;
            double sum_ms = 0.0;
            for (const double stage_ms : frame.stage_ms) sum_ms += stage_ms;
            update_ms.push_back(sum_ms);
        }
        figures.set("frames", static_cast<double>(record.frames.size()));
        figures.set("healthy",
                    static_cast<double>(healthy) / static_cast<double>(record.frames.size()));
        figures.set("ate_m", record.truth ? record.truth->trajectory.ate_rmse_m : std::nan(""));
        figures.set("update_hz",
                    update_ms.empty() ? std::nan("") : 1e3 / percentiles(update_ms).median);
    }

    [[nodiscard]] Status write_all(const std::string& folder,
                                   const RunRecord& record,
                                   const RatedMap& truth,
                                   const ComparedMap& compared,
                                   const RatedMap& ground,
                                   const sim::NamedNumbers& numbers) {
        eval::Overlays overlays;
        for (const FrameReport& frame : record.frames)
            overlays.trajectory_m.emplace_back(frame.motion.T_odom_body.translation_m.head<2>());
        overlays.T_odom_body = record.frames.back().motion.T_odom_body;
        Writes writes;
        writes += io::write_file(
            folder + "/camera.png",
            as_text(eval::render_camera_image(pipeline_->pair().left, {run_.title, "last image"})));
        writes += write_pictures(folder, truth, compared, overlays, settings_.maps.safe_threshold);
        writes += io::write_esri_grid(folder + "/elevation.asc", ground.geometry, ground.height_m);
        if (run_.stairs) {
            if (const auto box = box_of(*run_.stairs, numbers)) {
                writes += io::write_file(folder + "/heights.svg",
                                         box_heights_svg(cell_points_m(ground), *box, run_.title));
            }
        }
        return writes.first();
    }

    const ThesisRun& run_;
    ThesisColumn column_;
    const ThesisConditions& conditions_;
    const Settings& settings_;
    Serial serial_;
    std::unique_ptr<sim::SceneSource> source_;
    std::optional<pipeline::Pipeline> pipeline_;
    std::unique_ptr<grid::MapSnapshot> snapshot_ = std::make_unique<grid::MapSnapshot>();
};

}  // namespace

Result<ThesisFigures> scan_of_run(const ThesisRun& run,
                                  const ThesisConditions& conditions,
                                  Executor& executor) {
    const auto script = script_of(run, conditions);
    if (!script) return script.error();
    const auto place = scan_place(*script,
                                  conditions.settings.laser,
                                  conditions.seed,
                                  area_around(*script, kAround_m),
                                  conditions.settings.pipeline.elevation.resolution_m,
                                  executor);
    if (!place) return place.error();
    const std::string folder = conditions.scan_folder(run.scene);
    if (auto status = io::make_folder(folder); !status) return status.error();
    ThesisFigures figures;
    figures.set("stations", place->stations);
    figures.set("points_scanned", static_cast<double>(place->scanned));
    figures.set("points_kept", static_cast<double>(place->points_m.size()));
    const RatedMap map =
        rated_map(place->geometry, place->height_m, conditions.settings.pipeline.traversability);
    const sim::NamedNumbers numbers = sim::drawn_numbers(*script);
    if (auto status = measure_by_hand(run, numbers, place->points_m, map, figures); !status)
        return status.error();
    Writes writes;
    writes += io::write_esri_grid(folder + "/elevation.asc", place->geometry, place->height_m);
    if (run.stairs) {
        if (const auto box = box_of(*run.stairs, numbers)) {
            writes += io::write_file(folder + "/heights.svg",
                                     box_heights_svg(place->points_m, *box, "Laser scan"));
        }
    }
    if (!writes.first()) return writes.first().error();
    return figures;
}

Result<ThesisFigures> live_run(const ThesisRun& run,
                               ThesisColumn column,
                               const ThesisConditions& conditions) {
    const auto script = script_of(run, conditions);
    if (!script) return script.error();
    Settings settings = conditions.settings;
    if (column == ThesisColumn::thesis) {
        if (auto status = use_thesis_settings(run.preset, settings); !status) return status.error();
    }
    if (run.map_length_m > 0.0) settings.pipeline.elevation.length_m = run.map_length_m;
    if (const auto problem = settings.pipeline.problem()) return usage_error(*problem);
    LiveRun live(run, column, conditions, settings);
    if (auto status = live.open(); !status) return status.error();
    return live.finish(sim::drawn_numbers(*script));
}

Result<ThesisFigures> scan_of_courtyard(const ThesisConditions& conditions, Executor& executor) {
    const auto script = sim::make_scene(kThesisCourtyard, conditions.seed);
    if (!script) return script.error();
    // Half of a map length that is large enough for the whole courtyard [m].
    constexpr double kAll_m = 90.0;
    constexpr double kHill_m = 3.0;  // higher ceiling, because the ground rises far from the path
    ScanArea area = area_around(*script, kAll_m);
    area.farthest_m = 2.0 * kAll_m;
    area.ceiling_m += kHill_m;
    const auto place = scan_place(*script,
                                  conditions.settings.laser,
                                  conditions.seed,
                                  area,
                                  conditions.settings.pipeline.elevation.resolution_m,
                                  executor);
    if (!place) return place.error();
    const std::string folder = conditions.scan_folder(kThesisCourtyard);
    if (auto status = io::make_folder(folder); !status) return status.error();
    ThesisFigures figures;
    figures.set("stations", place->stations);
    figures.set("points_scanned", static_cast<double>(place->scanned));
    figures.set("points_kept", static_cast<double>(place->points_m.size()));
    Settings thesis = conditions.settings;
    if (auto status = use_thesis_settings("laser", thesis); !status) return status.error();
    const RatedMap map =
        rated_map(place->geometry, place->height_m, thesis.pipeline.traversability);
    const eval::ShownPart part = eval::shown_part(map.geometry, map.height_m, {});
    const auto write =
        [&](const char* name, const grid::Layer& layer, const eval::LayerStyle& style) {
            const eval::Picture picture = eval::render_layer(
                part.geometry, part.of(layer, std::nanf("")), style, eval::Overlays{});
            return io::write_file(fmt::format("{}/{}.png", folder, name), as_text(picture));
        };
    std::int64_t safe = 0;
    std::int64_t rated = 0;
    for (std::size_t i = 0; i < map.traversability.size(); ++i) {
        const float value = map.traversability.data()[i];
        if (std::isnan(value)) continue;
        ++rated;
        safe += static_cast<double>(value) >= conditions.settings.maps.safe_threshold ? 1 : 0;
    }
    figures.set("cells", static_cast<double>(rated));
    figures.set("safe_share",
                rated > 0 ? static_cast<double>(safe) / static_cast<double>(rated) : std::nan(""));
    const eval::ValueRange range = eval::shown_range(map.height_m, eval::elevation_style());
    Writes writes;
    writes += write("elevation", map.height_m, heights_style("Courtyard: heights", range));
    writes +=
        write("traversability",
              map.traversability,
              rating_style("Courtyard: traversability", conditions.settings.maps.safe_threshold));
    if (!writes.first()) return writes.first().error();
    return figures;
}

}  // namespace surefoot::app
