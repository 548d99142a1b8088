// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <span>
#include <vector>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/writes.hpp"
#include "studies/runs/height_image.hpp"
#include "studies/runs/map_layers.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

struct RateOptions {
    CommonOptions common;
    std::string dem;
    std::string out_dir;
    double scale_m_per_px = 0.0;
    double height_m = 0.0;
};

Result<io::Dem> read_dem(const RateOptions& options) {
    if (io::extension_of(options.dem) != ".png") return io::read_height_grid(options.dem);
    return read_height_image(options.dem, options.scale_m_per_px, options.height_m);
}

eval::LayerStyle style_of(const std::string& name, double safe_threshold) {
    const bool is_normal = name.starts_with("normal");
    eval::LayerStyle style =
        is_normal ? eval::LayerStyle{} : eval::traversability_style(safe_threshold);
    style.text.title = name;
    return style;
}

/// Writes a picture that shows the heights and all computed layers side by side.
Status write_sheet(const RateOptions& options,
                   const Settings& settings,
                   const io::Dem& dem,
                   std::span<const NamedLayer> rated) {
    std::vector<NamedLayer> layers{{"elevation", dem.values}};
    layers.insert(layers.end(), rated.begin(), rated.end());
    const auto png = layer_sheet_png(dem.geometry,
                                     layers,
                                     settings.maps.safe_threshold,
                                     4,
                                     {fmt::format("Rated: {}", options.dem), ""},
                                     {});
    return io::write_file(options.out_dir + "/layers.png", png);
}

/// `surefoot rate`: computes the traversability of a height map.
int rate(const RateOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto dem = read_dem(options);
    if (!dem) return report(dem.error());
    for (const std::string& note : dem->notes)
        log_warning(fmt::format("{}: {}", options.dem, note));
    const double resolution_m = dem->geometry.resolution_m;
    if (const auto problem = settings->pipeline.traversability.problem(resolution_m)) {
        return report(usage_error(fmt::format("{}: {}", options.dem, *problem)));
    }
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());

    const auto executor = make_executor(options.common);
    traversability::TraversabilityLayers layers;
    traversability::rate(
        settings->pipeline.traversability, dem->values.view(), resolution_m, *executor, layers);

    const NamedLayer outputs[] = {{"normal_x", layers.normal_x},
                                  {"normal_y", layers.normal_y},
                                  {"normal_z", layers.normal_z},
                                  {"slope", layers.slope},
                                  {"step", layers.step},
                                  {"roughness", layers.roughness},
                                  {"traversability", layers.traversability}};
    Writes writes;
    writes += io::write_config_of(options.out_dir + "/config.yaml", *settings);
    for (const auto& [name, layer] : outputs) {
        const auto png = encode_png(render_layer(
            dem->geometry, layer, style_of(name, settings->maps.safe_threshold), eval::Overlays{}));
        writes += io::write_esri_grid(
            fmt::format("{}/{}.asc", options.out_dir, name), dem->geometry, layer);
        writes += io::write_file(fmt::format("{}/{}.png", options.out_dir, name), png);
    }
    writes += write_sheet(options, *settings, *dem, outputs);
    if (!writes.first()) return report(writes.first().error());
    if (options.common.json) {
        print_answer(rate_json(dem->geometry, options.out_dir));
    } else {
        fmt::print("{} x {} cells of {:g} m are rated; the layers are in {}/\n",
                   dem->geometry.nx,
                   dem->geometry.ny,
                   resolution_m,
                   options.out_dir);
    }
    return kExitOk;
}

}  // namespace

void add_rate(VerbGroup verbs) {
    auto [verb, o] = verbs.add<RateOptions>(
        "rate",
        "rate the traversability of each cell of a height map",
        "surefoot rate out/floor/elevation.asc --preset rex_zed --out out/rated",
        rate);
    verb.option("dem",
                o.dem,
                "height map: an ESRI ASCII grid, or a PNG with the options --scale and --height")
        .required()
        .value("DEM");
    verb.option("--out", o.out_dir, "folder for the layers as grids and pictures")
        .required()
        .value("DIR");
    verb.option("--scale",
                o.scale_m_per_px,
                "if the height map is a PNG: side of a pixel on the ground, in m")
        .value("M")
        .positive();
    verb.option("--height",
                o.height_m,
                "if the height map is a PNG: height of a white pixel (value 255, or 65535 in a "
                "16-bit image), in m")
        .value("M")
        .positive();
}

}  // namespace surefoot::app
