// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/cloud_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"

namespace surefoot::app {
namespace {

struct VoxelOptions {
    CommonOptions common;
    std::string cloud;
    double size_m = 0.001;
    std::string out_file;
};

/// `surefoot voxel`: reduces a cloud to the mean point of each voxel.
int voxel(const VoxelOptions& options) {
    const auto executor = make_executor(options.common);
    const auto thinned = thin_cloud(options.cloud, options.size_m, options.out_file, *executor);
    if (!thinned) return report(thinned.error());
    tell_notes(options.cloud, thinned->notes);
    if (options.common.json) {
        print_answer(voxel_json(*thinned, options.size_m, options.out_file));
        return kExitOk;
    }
    fmt::print("{} of {} points remain, one for each voxel with a side of {:g} m; written to {}\n",
               thinned->voxels,
               thinned->points,
               options.size_m,
               options.out_file);
    tell_shift(thinned->shift_m);
    return kExitOk;
}

}  // namespace

void add_voxel(VerbGroup verbs) {
    auto [verb, o] = verbs.add<VoxelOptions>(
        "voxel",
        "reduce a point cloud of any size to one point for each voxel, the mean of its points",
        "surefoot voxel out/stairs.ply --size 0.01 --out "
        "out/stairs_10mm.ply",
        voxel,
        Reads::no_settings);
    verb.option("cloud", o.cloud, "point cloud: PLY, PCD, LAS, VTK or XYZ")
        .required()
        .value("CLOUD");
    verb.option("--size",
                o.size_m,
                "side of a voxel, in m (default 0.001); the borders of the voxels lie on multiples "
                "of this side")
        .value("M")
        .in(1e-5, 1e3);
    verb.option("--out",
                o.out_file,
                "file for the remaining points: PLY, PCD or XYZ. It contains only positions, "
                "sorted by x, y and z")
        .required()
        .value("F.ply");
}

}  // namespace surefoot::app
