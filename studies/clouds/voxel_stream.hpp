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

/// Result of thin_cloud().
struct ThinnedCloud {
    std::int64_t points = 0;   ///< number of finite input points
    std::int64_t skipped = 0;  ///< number of input points that were not finite
    std::int64_t voxels = 0;   ///< number of output points
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::vector<std::string> notes;  ///< sentences about properties that the output lacks
};

/// Returns a usage error if the box has more voxels than can be numbered. The error names `cloud`.
[[nodiscard]] Status check_voxels(const geometry::PointBox& box,
                                  double size_m,
                                  const std::string& cloud);

/// Writes the mean point of each voxel to `out_file`. Splits a cloud with more than
/// `most_in_memory` points into slabs along x and processes them one by one; this does not change
/// the output. The slabs lie in a temporary folder beside the output (12 bytes a point). Memory: 40
/// bytes for each of `most_in_memory` points, or for each point of the fullest slab if it has more.
[[nodiscard]] Result<ThinnedCloud> thin_cloud(const std::string& cloud,
                                              double size_m,
                                              const std::string& out_file,
                                              Executor& executor,
                                              std::int64_t most_in_memory = 16'000'000);

}  // namespace surefoot::app
