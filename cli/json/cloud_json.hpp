// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/clouds/voxel_stream.hpp"
#include "surefoot/eval/clouds/cloud_distance.hpp"
#include "surefoot/eval/clouds/cloud_measures.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"

// Functions that write the JSON of cloud verbs. Key names are a contract (docs/reference/json.md).
namespace surefoot::app {

[[nodiscard]] std::string voxel_json(const ThinnedCloud& thinned,
                                     double size_m,
                                     const std::string& file);

/// Result of filtering a point cloud.
struct KeptPoints {
    std::int64_t points = 0;
    std::int64_t kept = 0;
    std::int64_t skipped = 0;  ///< number of points that were not finite
    /// Origin that was subtracted from the coordinates during the computation.
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::vector<std::string> notes;  ///< input data that the output lacks
};
[[nodiscard]] std::string sor_json(const KeptPoints& result,
                                   int others,
                                   const eval::OutlierFilter& filter,
                                   const std::string& file);

/// `shift_m`: origin that was subtracted from the coordinates during the computation. The matrix
/// of `found` must apply to the original coordinates.
[[nodiscard]] std::string icp_json(const geometry::CloudAlignment& found,
                                   const Eigen::Vector3d& shift_m);

/// Result of comparing two clouds. Only the method M3C2 sets the last three members.
struct CloudComparison {
    std::string method;
    eval::DistanceFigures figures;
    std::int64_t skipped = 0;  ///< number of points without a distance
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::optional<std::int64_t> cores;
    std::int64_t significant = 0;
    double median_lod95_m = 0.0;
};
[[nodiscard]] std::string clouds_json(const CloudComparison& comparison);

/// Returns levels, stairs and the width of a door as JSON. `door_width_m`: outer nullopt = not
/// requested, no key; inner nullopt = requested but not found, written as null.
[[nodiscard]] std::string measure_json(const eval::HeightHistogram& heights,
                                       const eval::StairMeasures& stairs,
                                       const std::optional<std::optional<double>>& door_width_m,
                                       const Eigen::Vector3d& shift_m);

/// Logs a warning for each note about data of `cloud` that the output lacks.
void tell_notes(const std::string& cloud, const std::vector<std::string>& notes);
/// Logs the origin that was subtracted from the coordinates, unless it is zero.
void tell_shift(const Eigen::Vector3d& shift_m);

}  // namespace surefoot::app
