// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/writes.hpp"
#include "studies/runs/stairs_json.hpp"
#include "studies/runs/stairs_text.hpp"
#include "studies/runs/terrain_map.hpp"
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

struct StairsOptions {
    CommonOptions common;
    TerrainRequest terrain;
    std::string out_dir;  ///< folder for the results; empty = no files
};

/// Terrain features of a map, and the class of each cell.
struct Found {
    stairs::TerrainFeatures features;
    stairs::GroundClasses classes;
};

eval::Overlays stance_of(const TerrainMap& map) {
    eval::Overlays drawn;
    drawn.T_odom_body = map.T_odom_body;
    if (!map.T_odom_body) drawn.marks = {{map.stance_m, "position of the machine"}};
    return drawn;
}

/// Writes stairs.png, classes.png and a page with both pictures and the table of the features.
Status write_pictures(const StairsOptions& options, const TerrainMap& map, const Found& found) {
    const eval::Overlays drawn = stance_of(map);
    const auto stairs_png =
        eval::encode_png(eval::render_features(map.geometry,
                                               map.height_m,
                                               found.features,
                                               drawn,
                                               {"Edges and stairs", options.terrain.map}));
    const auto classes_png = eval::encode_png(eval::render_classes(
        map.geometry, map.height_m, found.classes, drawn, {"Ground classes", options.terrain.map}));
    eval::ReportContent content;
    content.title = fmt::format("Surefoot: stairs of {}", options.terrain.map);
    content.summary.push_back(features_count_text(found.features));
    if (const std::string note = gravity_note(map.gravity_source); !note.empty())
        content.summary.push_back(note);
    for (const std::string& sentence : map.assumed)
        content.summary.push_back("assumed: " + sentence);
    content.sections.push_back({"Ground classes",
                                {{"Edges, flights, drops, kerbs and doors", stairs_png},
                                 {"Ground class of each cell", classes_png}},
                                {features_table(found.features)}});
    content.footer =
        "The file stairs.json contains these results for other programs. The file config.yaml "
        "contains the settings.";
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
        fmt::print("stairs.json, treads.asc, stairs.png, classes.png and report.html are in {}/\n",
                   options.out_dir);
}

/// `surefoot stairs`: finds flights, drops, kerbs, sills, doors and edges in a height map.
int stairs(const StairsOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const stairs::StairsConfig& config = settings->pipeline.stairs;
    if (const auto problem = config.problem()) return report(usage_error(*problem));
    const auto map = load_terrain(options.terrain);
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

}  // namespace

void add_stairs(VerbGroup verbs) {
    auto [verb, o] = verbs.add<StairsOptions>("stairs",
                                              "find flights of stairs, drops, kerbs, sills, doors "
                                              "and edges in a height map or a point cloud",
                                              "surefoot stairs out/floor --out out/floor_edges\n"
                                              "  surefoot stairs out/stairs.ply --from 0,0 --json",
                                              stairs);
    verb.option("map",
                o.terrain.map,
                "map to search: the output folder of 'surefoot run' (best a run with --layers), an "
                "ESRI ASCII grid, a PNG with --scale and --height, or a point cloud with z up "
                "(PLY, PCD, LAS, VTK or XYZ)")
        .required()
        .value("DEM|CLOUD|FOLDER");
    verb.option(
            "--out",
            o.out_dir,
            "folder for stairs.json, treads.asc, report.html and the pictures (default: no files)")
        .value("DIR");
    verb.option("--from",
                o.terrain.from,
                "position of the machine, in m; an edge that goes down as seen from this position "
                "is a drop. Default: base_link of the run. Without a run the default is the "
                "origin, if its cell is known, or else the known cell nearest to the middle of the "
                "border with the smallest x")
        .value("X,Y");
    verb.option("--scale",
                o.terrain.scale_m_per_px,
                "if the height map is a PNG: side of a pixel on the ground, in m")
        .value("M")
        .positive();
    verb.option("--height",
                o.terrain.height_m,
                "if the height map is a PNG: height of a white pixel (value 255, or 65535 in a "
                "16-bit image), in m")
        .value("M")
        .positive();
    verb.option("--resolution",
                o.terrain.resolution_m,
                "if the map is a point cloud: side of a cell, in m")
        .value("M")
        .positive();
    verb.option("--min-height",
                o.terrain.lowest_z_m,
                "if the map is a point cloud: leave out the points below this z, in m")
        .value("M");
    verb.option("--max-height",
                o.terrain.highest_z_m,
                "if the map is a point cloud: leave out the points above this z, in m")
        .value("M");
}

}  // namespace surefoot::app
