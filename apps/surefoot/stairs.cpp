// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/stairs_json.hpp"
#include "apps/surefoot/stairs_text.hpp"
#include "apps/surefoot/terrain_map.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "eval/stairs_picture.hpp"
#include "io/config_yaml.hpp"
#include "io/file.hpp"
#include "surefoot/stairs/feature_finder.hpp"

namespace surefoot::app {
namespace {

std::string picture_of(const StairsOptions& options,
                       const TerrainMap& map,
                       const stairs::TerrainFeatures& features) {
    eval::Overlays drawn;
    drawn.T_odom_body = map.T_odom_body;
    if (!map.T_odom_body) drawn.marks = {{map.stance_m, "seen from here"}};
    const auto png = eval::encode_png(eval::render_features(
        map.geometry, map.height_m, features, drawn, {"Edges and stairs", options.map}));
    return {png.begin(), png.end()};
}

Status write_results(const StairsOptions& options,
                     const Settings& settings,
                     const TerrainMap& map,
                     const stairs::TerrainFeatures& features) {
    Writes writes;
    writes += io::write_config_of(options.out_dir + "/config.yaml", settings);
    writes +=
        io::write_file(options.out_dir + "/stairs.json", stairs_json(features, map.assumed) + "\n");
    writes += io::write_file(options.out_dir + "/stairs.png", picture_of(options, map, features));
    return writes.first();
}

void print_text(const StairsOptions& options,
                const TerrainMap& map,
                const stairs::TerrainFeatures& features) {
    fmt::print("{}{}\n", features_text(features), features_count_text(features));
    for (const std::string& sentence : map.assumed) fmt::print("assumed: {}\n", sentence);
    if (!options.out_dir.empty())
        fmt::print("stairs.json and stairs.png in {}/\n", options.out_dir);
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
    stairs::TerrainFeatures features;
    stairs::FeatureFinder(config).find(map->terrain(), features);
    if (!options.out_dir.empty()) {
        if (auto status = write_results(options, *settings, *map, features); !status)
            return report(status.error());
    }
    if (options.common.json) {
        print_answer(stairs_json(features, map->assumed));
    } else {
        print_text(options, *map, features);
    }
    return kExitOk;
}

}  // namespace surefoot::app
