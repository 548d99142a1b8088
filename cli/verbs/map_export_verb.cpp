// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/writes.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/map_file.hpp"

namespace surefoot::app {
namespace {

struct MapExportOptions {
    CommonOptions common;
    std::string file;
    std::string out_dir;
};

/// A layer as floats, because other programs read grids and clouds of floats.
struct FloatLayer {
    std::string name;    ///< name in the name of the .asc file
    std::string scalar;  ///< name in the point cloud, with its unit
    grid::Layer values;
};

template <typename F>
grid::Layer of_known_cells(const grid::MapRegion& region, const F& value_of) {
    grid::Layer out(region.box.nx, region.box.ny, std::nanf(""));
    for (std::size_t i = 0; i < out.size(); ++i)
        if (!std::isnan(region.height_m.data()[i])) out.data()[i] = value_of(i);
    return out;
}

/// Returns the seconds from the last observation of each cell to the stamp of the map. A float
/// cannot represent a time stamp in nanoseconds.
FloatLayer age_of(const grid::MapRegion& region) {
    return {"age", "age_s", of_known_cells(region, [&](std::size_t i) {
                const std::int64_t seen_ns = region.seen_ns.data()[i];
                if (seen_ns == 0) return std::nanf("");  // never observed in this run
                return static_cast<float>(
                    1e-9 * (static_cast<double>(region.stamp_ns) - static_cast<double>(seen_ns)));
            })};
}

std::vector<FloatLayer> float_layers(const grid::MapRegion& region) {
    std::vector<FloatLayer> layers;
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto member, auto unknown) {
        if constexpr (std::is_same_v<decltype(unknown), std::int64_t>) {
            layers.push_back(age_of(region));
        } else {
            const std::string name = layer.name;
            const std::string scalar = *layer.unit == '\0' ? name : name + "_" + layer.unit;
            layers.push_back({name, scalar, of_known_cells(region, [&](std::size_t i) {
                                  return static_cast<float>((region.*member).data()[i]);
                              })});
        }
    });
    return layers;
}

/// Returns one point for each known cell. z is the elevation; every other layer is a scalar.
io::PointCloud cloud_of(const grid::MapRegion& region, const std::vector<FloatLayer>& layers) {
    const grid::GridGeometry geometry = region.geometry();
    io::PointCloud cloud;
    for (const FloatLayer& layer : layers)
        if (layer.name != "elevation") cloud.scalars.push_back({layer.scalar, {}});
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const float z_m = region.height_m.at(ix, iy);
            if (std::isnan(z_m)) continue;
            const Eigen::Vector2d center_m = geometry.center_m({ix, iy});
            cloud.points_m.emplace_back(center_m.x(), center_m.y(), z_m);
            auto scalar = cloud.scalars.begin();
            for (const FloatLayer& layer : layers)
                if (layer.name != "elevation")
                    (scalar++)->floats().push_back(layer.values.at(ix, iy));
        }
    }
    cloud.width = static_cast<int>(cloud.points_m.size());
    return cloud;
}

/// Attempts to write every file, and collects the names of the written files.
struct Export {
    std::string folder;
    Writes writes;
    std::vector<std::string> files;

    void add(const std::string& name, Status status) {
        if (status) files.push_back(name);
        writes += std::move(status);
    }
    void add_picture(const std::string& name,
                     const grid::MapRegion& region,
                     const grid::Layer& values,
                     const eval::LayerStyle& style) {
        eval::Overlays overlays;
        overlays.T_odom_body = region.T_frame_body;
        const auto png =
            eval::encode_png(eval::render_layer(region.geometry(), values, style, overlays));
        add(name, io::write_file(io::join_path(folder, name), png));
    }
};

/// `surefoot map export`: writes a saved map in other formats.
int map_export(const MapExportOptions& options) {
    const auto map = io::read_map(options.file);
    if (!map) return report(map.error());
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());
    const grid::MapRegion& region = map->region;
    Export out{options.out_dir, {}, {}};
    const std::vector<FloatLayer> layers = float_layers(region);
    for (const FloatLayer& layer : layers) {
        const std::string name = layer.name + ".asc";
        const std::string path = io::join_path(options.out_dir, name);
        out.add(name, io::write_esri_grid(path, region.geometry(), layer.values));
    }
    const std::string cloud_path = io::join_path(options.out_dir, "map.ply");
    out.add("map.ply", io::write_ply(cloud_path, cloud_of(region, layers)));
    out.add_picture("elevation.png", region, region.height_m, eval::elevation_style());
    out.add_picture(
        "sigma.png",
        region,
        of_known_cells(region,
                       [&](std::size_t i) { return std::sqrt(region.height_var_m2.data()[i]); }),
        eval::height_sigma_style());
    const Status written = out.writes.first();
    if (options.common.json) {
        print_answer(map_export_json(region, out.files, options.out_dir));
    } else {
        fmt::print("the map has {} known cells of {}; {} files are written to {}/\n",
                   region.known_cells(),
                   region.height_m.size(),
                   out.files.size(),
                   options.out_dir);
    }
    return written ? kExitOk : report(written.error());
}

}  // namespace

void add_map_export(VerbGroup verbs) {
    auto [verb, o] = verbs.add<MapExportOptions>(
        "export",
        "convert a saved map: write every layer as .asc, the known cells as a point cloud, and "
        "pictures of the elevation and its standard deviation",
        "surefoot map export out/modelled/floor.region --out "
        "out/floor_map",
        map_export,
        Reads::no_settings);
    verb.option("file", o.file, "saved map, written by 'surefoot run --save-map'")
        .required()
        .value("FILE");
    verb.option("--out", o.out_dir, "folder for the written files").required().value("DIR");
}

}  // namespace surefoot::app
