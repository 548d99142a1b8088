// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/eval_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/writes.hpp"
#include "studies/runs/run_json.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

struct EvalMapsOptions {
    CommonOptions common;
    std::string live_dir;
    std::string truth_dir;
    std::string out_dir;  ///< folder for pictures; empty = no pictures
};

/// Loads the settings of the run, so that the true map is rated with the same settings. With
/// --config, or if the folder has no config.yaml, loads the settings of this call.
Result<Settings> settings_of(const EvalMapsOptions& options) {
    CommonOptions common = options.common;
    const std::string used = options.live_dir + "/config.yaml";
    if (common.config_file.empty() && io::is_file(used)) common.config_file = used;
    return load_settings(common);
}

/// Rates the traversability of the true heights with the settings of the run.
grid::Layer rated(const Settings& settings, const grid::Layer& truth_m, double resolution_m) {
    Serial serial;
    traversability::TraversabilityLayers layers;
    traversability::rate(settings.pipeline.traversability.widened_to(resolution_m),
                         truth_m.view(),
                         resolution_m,
                         serial,
                         layers);
    return layers.traversability;
}

/// Reads another layer of the run. Its size must equal the size of elevation.asc.
Result<grid::Layer> read_layer(const std::string& path, const grid::GridGeometry& geometry) {
    const auto dem = io::read_esri_grid(path);
    if (!dem) return dem.error();
    if (dem->geometry.nx == geometry.nx && dem->geometry.ny == geometry.ny) return dem->values;
    return input_error(
        fmt::format("{}: this layer has {} x {} cells, but elevation.asc in the same folder has {} "
                    "x {}; write both with the same run",
                    path,
                    dem->geometry.nx,
                    dem->geometry.ny,
                    geometry.nx,
                    geometry.ny));
}

/// Adds the poses and the camera of the run, if its folder contains them.
Status add_track(const EvalMapsOptions& options, const Settings& settings, eval::MapPair& maps) {
    const std::string track_file = options.live_dir + "/trajectory.tum";
    if (!io::is_file(track_file)) return {};
    auto track = io::read_trajectory(track_file);
    if (!track) return track.error();
    maps.trajectory = std::move(track->poses);
    const std::string report_file = options.live_dir + "/report.json";
    if (!io::is_file(report_file)) return {};
    const auto text = io::read_file(report_file);
    if (!text) return text.error();
    maps.tilt_sigma_rad = parse_report_tilt_sigma_rad(*text);
    const auto camera = parse_report_camera(*text);
    if (!camera) return {};
    eval::CameraTrack seen;
    seen.view = camera->view;
    seen.max_depth_m = settings.pipeline.elevation.prefilter.max_range_m;
    for (const StampedPose& pose : maps.trajectory)
        seen.T_world_camera.push_back({pose.time_ns, pose.T_world_body * camera->T_body_camera});
    maps.camera = std::move(seen);
    return {};
}

Result<eval::MapPair> read_maps(const EvalMapsOptions& options, const Settings& settings) {
    const auto live = io::read_height_grid(options.live_dir + "/elevation.asc");
    if (!live) return live.error();
    const auto truth = io::read_height_grid(options.truth_dir + "/elevation.asc");
    if (!truth) return truth.error();
    for (const io::Dem* dem : {&*live, &*truth})
        for (const std::string& note : dem->notes) log_warning(note);
    eval::MapPair maps;
    maps.geometry = live->geometry;
    maps.live_m = live->values;
    auto rating = read_layer(options.live_dir + "/traversability.asc", live->geometry);
    if (!rating) return rating.error();
    maps.live_traversability = std::move(*rating);
    const std::string variance_file = options.live_dir + "/variance.asc";
    if (io::is_file(variance_file)) {
        auto variance = read_layer(variance_file, live->geometry);
        if (!variance) return variance.error();
        maps.live_var_m2 = std::move(*variance);
    }
    maps.truth_m = eval::resample_nearest(truth->geometry, truth->values, live->geometry);
    maps.truth_traversability = rated(settings, maps.truth_m, live->geometry.resolution_m);
    if (auto status = add_track(options, settings, maps); !status) return status.error();
    return maps;
}

Status write_pictures(const EvalMapsOptions& options,
                      const eval::MapPair& maps,
                      const eval::MapComparison& result) {
    if (auto status = io::make_folder(options.out_dir); !status) return status;
    eval::Overlays overlays;
    for (const StampedPose& pose : maps.trajectory)
        overlays.trajectory_m.push_back(pose.T_world_body.translation_m.head<2>());
    const auto write = [&](const char* name, const eval::Picture& picture) {
        const auto png = eval::encode_png(picture);
        return io::write_file(options.out_dir + "/" + name, png);
    };
    Writes writes;
    writes +=
        write("confusion.png",
              eval::render_confusion(maps.geometry,
                                     result.calls,
                                     {"Traversability compared with the truth",
                                      fmt::format("{:.2f} % of the unsafe cells called safe, "
                                                  "{:.2f} % of the safe cells called unsafe",
                                                  100.0 * result.traversability.false_safe,
                                                  100.0 * result.traversability.false_unsafe)},
                                     overlays));
    writes +=
        write("error.png",
              eval::render_error_map(
                  maps.geometry,
                  result.error_m,
                  {"Height error",
                   fmt::format("magnitude: median {:.1f} mm, 90 % of the cells at most {:.1f} mm",
                               1e3 * result.elevation.median_abs_m,
                               1e3 * result.elevation.p90_abs_m)},
                  overlays));
    return writes.first();
}

void print_figures(const eval::MapComparison& result) {
    fmt::print(
        "elevation error: median magnitude {:.1f} mm, 90 % of the cells at most {:.1f} mm, number "
        "of cells {}; {:.2f} % of the cells away from edges have an error above 50 "
        "mm\ntraversability: {:.2f} % of the unsafe cells called safe, {:.2f} % of the safe cells "
        "called unsafe\n{:.1f} % of the cells of the true map are known in the map of the run\n",
        1e3 * result.elevation.median_abs_m,
        1e3 * result.elevation.p90_abs_m,
        result.elevation.count,
        100.0 * result.elevation_away_from_edges.share_over_50mm,
        100.0 * result.traversability.false_safe,
        100.0 * result.traversability.false_unsafe,
        100.0 * result.coverage);
    if (result.sigma.count > 0) {
        fmt::print(
            "cells away from edges with an error within 1 sigma: {:.1f} %, within 2 sigma: {:.1f} "
            "%, within 3 sigma: {:.1f} %\n",
            100.0 * result.sigma.within_1_sigma,
            100.0 * result.sigma.within_2_sigma,
            100.0 * result.sigma.within_3_sigma);
    }
    if (result.floor.count > 0) {
        fmt::print(
            "level floor: spread of the heights {:.1f} mm, 99 % of the height steps between "
            "neighbouring cells are below {:.1f} mm\n",
            1e3 * result.floor.spread_m,
            1e3 * result.edges.p99_abs);
    }
}

/// `surefoot eval maps`: compares elevation and traversability with a true map.
int eval_maps(const EvalMapsOptions& options) {
    const auto settings = settings_of(options);
    if (!settings) return report(settings.error());
    const auto maps = read_maps(options, *settings);
    if (!maps) return report(maps.error());
    const eval::MapComparison result = eval::compare_maps(*maps, settings->maps);
    if (result.elevation.count == 0) {
        return report(input_error(fmt::format(
            "{} and {} have no known cell in common; check that both maps use the same frame",
            options.live_dir,
            options.truth_dir)));
    }
    if (options.common.json) {
        print_answer(maps_json(result));
    } else {
        print_figures(result);
    }
    if (options.out_dir.empty()) return kExitOk;
    const auto status = write_pictures(options, *maps, result);
    return status ? kExitOk : report(status.error());
}

}  // namespace

void add_eval_maps(VerbGroup verbs) {
    auto [verb, o] = verbs.add<EvalMapsOptions>(
        "maps",
        "compare the elevation and the traversability of a run with a true map",
        "surefoot eval maps out/floor out/floor_recording --json",
        eval_maps,
        Reads::own_settings);
    verb.option("live", o.live_dir, "output folder of 'surefoot run'").required().value("LIVE_DIR");
    verb.option(
            "truth",
            o.truth_dir,
            "folder with the true elevation.asc, for example an output folder of 'surefoot sim'")
        .required()
        .value("TRUTH_DIR");
    verb.option("--out",
                o.out_dir,
                "folder for pictures: confusion.png (wrongly rated cells) and error.png (height "
                "errors)")
        .value("DIR");
}

}  // namespace surefoot::app
