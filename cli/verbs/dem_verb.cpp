// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/map_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "studies/clouds/surface_dem.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/height_rules.hpp"

namespace surefoot::app {
namespace {

struct DemOptions {
    CommonOptions common;
    std::string cloud;
    double resolution_m = 0.0;
    std::string reduce = "max";
    /// Points below this z are left out; only for reduce = "surface".
    std::optional<double> lowest_z_m;
    /// Points above this z are left out; only for reduce = "surface".
    std::optional<double> highest_z_m;
    std::string lattice = "cell";
    std::string out_file;
};

eval::Reduce reduce_named(const std::string& name) {
    if (name == "mean") return eval::Reduce::mean;
    return name == "min" ? eval::Reduce::min : eval::Reduce::max;
}

/// Computes the height of each cell as the largest, mean or smallest z of its points.
Result<grid::Layer> heights_of(const DemOptions& options,
                               io::CloudStream& cloud,
                               const eval::DemGrid& grid) {
    if (options.lowest_z_m || options.highest_z_m) {
        return usage_error(
            fmt::format("--min-height and --max-height work with --reduce surface only, not with "
                        "--reduce {}; remove them or give --reduce surface",
                        options.reduce));
    }
    const auto executor = make_executor(options.common);
    eval::DemBuilder builder(grid, reduce_named(options.reduce));
    const auto read = cloud.each_block([&](const io::PointCloud& block) {
        builder.add(block.points_m, *executor);
        return Status();
    });
    if (!read) return read.error();
    return builder.heights_m();
}

Result<grid::Layer> highest_surfaces(const DemOptions& options,
                                     io::CloudStream& cloud,
                                     const eval::DemGrid& grid) {
    const auto rules = surface_rules(options.lowest_z_m, options.highest_z_m);
    if (!rules) return rules.error();
    const auto executor = make_executor(options.common);
    const auto each_block = [&](const auto& take) {
        return cloud.each_block([&](const io::PointCloud& block) { return take(block.points_m); });
    };
    auto dem = surface_dem(grid, *rules, each_block, *executor);
    if (!dem) return dem.error();
    if (const std::string text = left_out_text(*dem); !text.empty()) log_info(text);
    return std::move(dem->height_m);
}

/// `surefoot dem`: makes a height map from a cloud.
int dem(const DemOptions& options) {
    auto cloud = io::CloudStream::open(options.cloud);
    if (!cloud) return report(cloud.error());
    const auto executor = make_executor(options.common);
    eval::CloudBounds bounds;
    const auto read = cloud->each_block([&](const io::PointCloud& block) {
        bounds.add(block.points_m, *executor);
        return Status();
    });
    if (!read) return report(read.error());
    const auto grid =
        bounds.grid(options.resolution_m,
                    options.lattice == "node" ? eval::Lattice::node : eval::Lattice::cell);
    if (!grid) {
        return report(
            {grid.error().code, fmt::format("{}: {}", options.cloud, grid.error().message)});
    }
    auto reduced = options.reduce == "surface" ? highest_surfaces(options, *cloud, *grid)
                                               : heights_of(options, *cloud, *grid);
    if (!reduced) return report(reduced.error());
    grid::Layer& heights_m = *reduced;
    for (const std::string& note : io::drop_impossible_heights(heights_m))
        log_warning(fmt::format("{}: {}", options.cloud, note));
    if (auto status = io::write_esri_grid(options.out_file, grid->geometry, heights_m); !status)
        return report(status.error());
    std::int64_t known = 0;
    for (std::size_t i = 0; i < heights_m.size(); ++i)
        known += std::isnan(heights_m.data()[i]) ? 0 : 1;
    if (options.common.json) {
        print_answer(dem_json(grid->geometry, known, bounds, options.out_file));
    } else {
        fmt::print(
            "{} points on a height map of {} x {} cells of {:g} m; {} cells have a height; written "
            "to {}\n",
            bounds.points(),
            grid->geometry.nx,
            grid->geometry.ny,
            options.resolution_m,
            known,
            options.out_file);
    }
    return kExitOk;
}

}  // namespace

void add_dem(VerbGroup verbs) {
    auto [verb, o] = verbs.add<DemOptions>("dem",
                                           "make a height map of a point cloud",
                                           "surefoot dem out/floor/map.ply --resolution 0.05 --out "
                                           "out/floor_dem.asc",
                                           dem,
                                           Reads::no_settings);
    verb.option(
            "cloud", o.cloud, "point cloud of any size, with z up, as PLY, PCD, LAS, VTK or XYZ")
        .required()
        .value("CLOUD");
    verb.option("--resolution", o.resolution_m, "side of a square cell of the height map, in m")
        .required()
        .value("M")
        .in(1e-4, 1e3);
    verb.option("--reduce",
                o.reduce,
                "height of a cell: largest, mean or smallest z of its points (default max), or "
                "surface. surface = the highest surface that enough points share and that does not "
                "hang in the air, as in the live map")
        .one_of({"max", "mean", "min", "surface"});
    verb.option("--min-height",
                o.lowest_z_m,
                "with --reduce surface: leave out the points below this z, in m")
        .value("M");
    verb.option("--max-height",
                o.highest_z_m,
                "with --reduce surface: leave out the points above this z, in m")
        .value("M");
    verb.option("--lattice",
                o.lattice,
                "position of the cells. cell (default): cell borders lie on multiples of the "
                "resolution; node: the centre of the first cell lies at the smallest x and y of "
                "the points")
        .one_of({"cell", "node"});
    verb.option("--out", o.out_file, "file for the height map, an ESRI ASCII grid")
        .required()
        .value("F.asc");
}

}  // namespace surefoot::app
