// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/geometry/point_box.hpp"

namespace surefoot::app {

/// What was made of a cloud.
struct ThinnedCloud {
    std::int64_t points = 0;   ///< that were finite
    std::int64_t skipped = 0;  ///< that were not
    std::int64_t voxels = 0;   ///< points that are left
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::vector<std::string> notes;  ///< what the output does not hold of the cloud
};

/// Refuses a box whose voxels cannot be numbered; `cloud` is for the error.
[[nodiscard]] Status check_voxels(const geometry::PointBox& box,
                                  double size_m,
                                  const std::string& cloud);

/// One point for each voxel, their mean, written as the cloud `out_file`. Clouds with more points
/// than `most_in_memory` are dealt out into slabs along x in a folder beside the output, 12 bytes a
/// point, which are then worked on one after the other; the output is the same. Memory: 40 bytes
/// for each point in memory, or of the fullest run of 64 voxels along x where that is more.
[[nodiscard]] Result<ThinnedCloud> thin_cloud(const std::string& cloud,
                                              double size_m,
                                              const std::string& out_file,
                                              Executor& executor,
                                              std::int64_t most_in_memory = 16'000'000);

}  // namespace surefoot::app
