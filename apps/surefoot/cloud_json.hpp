// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot/voxel_stream.hpp"
#include "surefoot/eval/clouds/cloud_distance.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"

// The JSON objects of the cloud tools; the names are a contract (docs/reference/json.md).
namespace surefoot::app {

[[nodiscard]] std::string voxel_json(const ThinnedCloud& thinned,
                                     double size_m,
                                     const std::string& file);

/// What a filter left of a cloud.
struct KeptPoints {
    std::int64_t points = 0;
    std::int64_t kept = 0;
    std::int64_t skipped = 0;  ///< that were not finite
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::vector<std::string> notes;  ///< what the output does not hold of the input
};
[[nodiscard]] std::string sor_json(const KeptPoints& result,
                                   int others,
                                   const eval::OutlierFilter& filter,
                                   const std::string& file);

/// `shift_m`: where coordinates were counted from in between; the matrix is of whole ones.
[[nodiscard]] std::string icp_json(const geometry::CloudAlignment& found,
                                   const Eigen::Vector3d& shift_m);

/// What two clouds differ by; the last three of M3C2 alone.
struct CloudComparison {
    std::string method;
    eval::DistanceFigures figures;
    std::int64_t skipped = 0;  ///< points without a distance
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::optional<std::int64_t> cores;
    std::int64_t significant = 0;
    double median_lod95_m = 0.0;
};
[[nodiscard]] std::string clouds_json(const CloudComparison& comparison);

/// Levels, stairs and, where it was asked for, the width of a door; null where none was found.
[[nodiscard]] std::string measure_json(const eval::HeightHistogram& heights,
                                       const eval::StairMeasures& stairs,
                                       const std::optional<std::optional<double>>& door_width_m,
                                       const Eigen::Vector3d& shift_m);

/// Says what an output does not hold of a cloud.
void tell_notes(const std::string& cloud, const std::vector<std::string>& notes);
/// Says where coordinates were counted from, if it was not zero.
void tell_shift(const Eigen::Vector3d& shift_m);

}  // namespace surefoot::app
