// SPDX-License-Identifier: Apache-2.0
#include "eval/dem.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "io/cloud_stream.hpp"
#include "io/dem_file.hpp"
#include "io/height_rules.hpp"

namespace surefoot::app {
namespace {

eval::Reduce reduce_named(const std::string& name) {
    if (name == "mean") return eval::Reduce::mean;
    return name == "min" ? eval::Reduce::min : eval::Reduce::max;
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
    eval::DemBuilder builder(*grid, reduce_named(options.reduce));
    const auto read_again = cloud->each_block([&](const io::PointCloud& block) {
        builder.add(block.points_m, *executor);
        return Status();
    });
    if (!read_again) return report(read_again.error());
    grid::Layer heights_m = builder.heights_m();
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
