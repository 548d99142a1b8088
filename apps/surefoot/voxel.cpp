// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/cloud_json.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"

namespace surefoot::app {

int voxel(const VoxelOptions& options) {
    const auto executor = make_executor(options.common);
    const auto thinned = thin_cloud(options.cloud, options.size_m, options.out_file, *executor);
    if (!thinned) return report(thinned.error());
    tell_notes(options.cloud, thinned->notes);
    if (options.common.json) {
        print_answer(voxel_json(*thinned, options.size_m, options.out_file));
        return kExitOk;
    }
    fmt::print("{} points of {} left, one for each voxel of {:g} m, in {}\n",
               thinned->voxels,
               thinned->points,
               options.size_m,
               options.out_file);
    tell_shift(thinned->shift_m);
    return kExitOk;
}

}  // namespace surefoot::app
