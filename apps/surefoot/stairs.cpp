// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/stairs_json.hpp"
#include "apps/surefoot/stairs_text.hpp"
#include "apps/surefoot/terrain_map.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "surefoot/eval/report/html_report.hpp"
#include "surefoot/eval/stairs/classes_picture.hpp"
#include "surefoot/eval/stairs/stairs_picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"
#include "surefoot/stairs/feature_finder.hpp"

namespace surefoot::app {
namespace {

/// Terrain features of a map, and the class of each cell.
struct Found {
    stairs::TerrainFeatures features;
    stairs::GroundClasses classes;
};

eval::Overlays stance_of(const TerrainMap& map) {
    eval::Overlays drawn;
    drawn.T_odom_body = map.T_odom_body;
    if (!map.T_odom_body) drawn.marks = {{map.stance_m, "seen from here"}};
    return drawn;
}

/// Writes stairs.png, classes.png and a page with both pictures and the table of the features.
Status write_pictures(const StairsOptions& options, const TerrainMap& map, const Found& found) {
    const eval::Overlays drawn = stance_of(map);
    const auto stairs_png = eval::encode_png(eval::render_features(
        map.geometry, map.height_m, found.features, drawn, {"Edges and stairs", options.map}));
    const auto classes_png = eval::encode_png(eval::render_classes(
        map.geometry, map.height_m, found.classes, drawn, {"What the ground is", options.map}));
    eval::ReportContent content;
    content.title = fmt::format("Surefoot: stairs of {}", options.map);
    content.summary.push_back(features_count_text(found.features));
    if (const std::string note = gravity_note(map.gravity_source); !note.empty())
        content.summary.push_back(note);
    for (const std::string& sentence : map.assumed)
        content.summary.push_back("assumed: " + sentence);
    content.sections.push_back({"What the ground is",
                                {{"Edges, flights, drops, kerbs and doors", stairs_png},
                                 {"The class of each cell", classes_png}},
                                {features_table(found.features)}});
    content.footer = "The same for programs: stairs.json; the settings: config.yaml.";
    Writes writes;
    writes += io::write_file(options.out_dir + "/stairs.png", stairs_png);
    writes += io::write_file(options.out_dir + "/classes.png", classes_png);
    writes += io::write_file(options.out_dir + "/report.html", eval::render_html(content));
    return writes.first();
}

std::string json_of(const TerrainMap& map, const Found& found) {
    return stairs_json(found.features,
                       found.classes,
                       {.resolution_m = map.geometry.resolution_m,
                        .gravity_source = map.gravity_source,
                        .assumed = map.assumed});
}

Status write_results(const StairsOptions& options,
                     const Settings& settings,
                     const TerrainMap& map,
                     const Found& found) {
    Writes writes;
    writes += io::write_config_of(options.out_dir + "/config.yaml", settings);
    writes += io::write_file(options.out_dir + "/stairs.json", json_of(map, found) + "\n");
    writes += io::write_esri_grid(
        options.out_dir + "/treads.asc", map.geometry, found.classes.tread_height_m);
    writes += write_pictures(options, map, found);
    return writes.first();
}

void print_text(const StairsOptions& options,
                const TerrainMap& map,
                const stairs::TerrainFeatures& features) {
    fmt::print("{}{}\n", features_text(features), features_count_text(features));
    if (const std::string note = gravity_note(map.gravity_source); !note.empty())
        fmt::print("{}\n", note);
    for (const std::string& sentence : map.assumed) fmt::print("assumed: {}\n", sentence);
    if (!options.out_dir.empty())
        fmt::print("stairs.json, treads.asc, stairs.png, classes.png and report.html in {}/\n",
                   options.out_dir);
}

}  // namespace

int stairs(const StairsOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const stairs::StairsConfig& config = settings->pipeline.stairs;
    if (const auto problem = config.problem()) return report(usage_error(*problem));
    const auto map = load_terrain(options);
    if (!map) return report(map.error());
    if (!options.out_dir.empty()) {
        if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());
    }
    Found found;
    stairs::FeatureFinder(config).find(map->terrain(), found.features);
    found.classes = stairs::classify_ground(config, map->terrain(), found.features);
    if (!options.out_dir.empty()) {
        if (auto status = write_results(options, *settings, *map, found); !status)
            return report(status.error());
    }
    if (options.common.json) {
        print_answer(json_of(*map, found));
    } else {
        print_text(options, *map, found.features);
    }
    return kExitOk;
}

}  // namespace surefoot::app
