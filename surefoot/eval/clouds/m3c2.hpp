// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::eval {

enum class M3c2Normals : std::uint8_t {
    vertical,  ///< compares heights along z, as maps do
    pca,       ///< normal of the reference around each core point, pointing up
};
inline constexpr const char* kM3c2NormalsNames[] = {"vertical", "pca"};

/// Parameters with the names of CloudCompare's plugin: two diameters and a half length.
struct M3c2Config {
    M3c2Normals normals = M3c2Normals::vertical;
    double normal_diameter_m = 0.10;      ///< diameter of the ball of points that give the normal
    double projection_diameter_m = 0.05;  ///< diameter of the cylinder along the normal
    double half_length_m = 0.10;          ///< half length of the cylinder
    double registration_error_m = 0.0;    ///< one sigma; increases the level of detection
    int min_points = 5;                   ///< least number of points of each cloud for a lod95
    void describe(ConfigVisitor& visitor);
};

/// Result of M3C2 at one core point.
struct M3c2Value {
    double distance_m = kNan;       ///< compared - reference along the normal; NaN if unknown
    double lod95_m = kNan;          ///< level of detection (95 %); NaN: too few points
    double std_reference_m = kNan;  ///< standard deviation along the normal, divisor n
    double std_compared_m = kNan;
    int count_reference = 0;
    int count_compared = 0;
    bool significant = false;  ///< |distance| is above lod95
    Eigen::Vector3f normal = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
};

/// M3C2 of Lague, Brodu and Leroux 2013, "Accurate 3D comparison of complex topography with
/// terrestrial laser scanner". Averages the points of both clouds along a cylinder around each core
/// point. LOD95 = 1.96 (sqrt(s1^2 / n1 + s2^2 / n2) + registration error), for standard deviations
/// s and counts n. Results are in the order of `cores_m`, which must be finite.
[[nodiscard]] std::vector<M3c2Value> m3c2(const geometry::KdTree& reference,
                                          const geometry::KdTree& compared,
                                          std::span<const Eigen::Vector3f> cores_m,
                                          const M3c2Config& config,
                                          Executor& executor = serial());

}  // namespace surefoot::eval
