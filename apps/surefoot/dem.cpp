// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/dem.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/surface_dem.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/height_rules.hpp"

namespace surefoot::app {
namespace {

eval::Reduce reduce_named(const std::string& name) {
    if (name == "mean") return eval::Reduce::mean;
    return name == "min" ? eval::Reduce::min : eval::Reduce::max;
}

/// Height of each cell by --reduce max, mean or min.
Result<grid::Layer> heights_of(const DemOptions& options,
                               io::CloudStream& cloud,
                               const eval::DemGrid& grid) {
    if (options.lowest_z_m || options.highest_z_m) {
        return usage_error(fmt::format(
            "--min-height and --max-height belong to --reduce surface, not to --reduce {}",
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

}  // namespace

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
        fmt::print("{} points on {} x {} cells of {:g} m, {} of them known, in {}\n",
                   bounds.points(),
                   grid->geometry.nx,
                   grid->geometry.ny,
                   options.resolution_m,
                   known,
                   options.out_file);
    }
    return kExitOk;
}

}  // namespace surefoot::app
