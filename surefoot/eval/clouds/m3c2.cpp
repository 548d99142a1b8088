// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/m3c2.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/core/pieces.hpp"
#include "surefoot/geometry/surface_normal.hpp"

namespace surefoot::eval {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kTaken = 256;  ///< core points in one task of a thread

/// Statistics of one cloud's points in the cylinder: positions along the axis, from the centre.
struct InCylinder {
    int count = 0;
    double mean_m = 0.0;
    double std_m = kNan;
};

InCylinder look(const geometry::KdTree& cloud, const geometry::Cylinder& cylinder) {
    const Eigen::Vector3d middle_m = cylinder.middle_m.cast<double>();
    const Eigen::Vector3d axis = cylinder.axis.cast<double>();
    const auto radius_m = static_cast<double>(cylinder.radius_m);
    const auto half_length_m = static_cast<double>(cylinder.half_length_m);
    InCylinder seen;
    double sum_m = 0.0;
    double sum_sq_m2 = 0.0;
    const auto add = [&](std::span<const Vector3f> run, std::size_t copies) {
        const auto weight = static_cast<double>(copies);
        for (const Vector3f& p_m : run) {
            const Eigen::Vector3d to_m = p_m.cast<double>() - middle_m;
            const double along_m = to_m.dot(axis);
            if (std::abs(along_m) > half_length_m) continue;
            if ((to_m - along_m * axis).squaredNorm() > radius_m * radius_m) continue;
            seen.count += static_cast<int>(copies);
            sum_m += weight * along_m;
            sum_sq_m2 += weight * along_m * along_m;
        }
    };
    cloud.runs_near_cylinder(cylinder, add);
    if (seen.count == 0) return seen;
    seen.mean_m = sum_m / seen.count;
    // Positions are relative to the core point, so that cancellation loses far less than a
    // micrometre.
    seen.std_m = std::sqrt(std::max(0.0, sum_sq_m2 / seen.count - seen.mean_m * seen.mean_m));
    return seen;
}

M3c2Value compare(const geometry::KdTree& reference,
                  const geometry::KdTree& compared,
                  const Vector3f& core_m,
                  const M3c2Config& config) {
    M3c2Value value;
    const auto normal =
        config.normals == M3c2Normals::vertical
            ? std::optional(Vector3f(Vector3f::UnitZ()))
            : geometry::surface_normal(
                  reference, core_m, static_cast<float>(0.5 * config.normal_diameter_m));
    if (!normal) return value;
    value.normal = *normal;
    const geometry::Cylinder cylinder{core_m,
                                      *normal,
                                      static_cast<float>(0.5 * config.projection_diameter_m),
                                      static_cast<float>(config.half_length_m)};
    const InCylinder first = look(reference, cylinder);
    const InCylinder second = look(compared, cylinder);
    value.count_reference = first.count;
    value.count_compared = second.count;
    value.std_reference_m = first.std_m;
    value.std_compared_m = second.std_m;
    if (first.count == 0 || second.count == 0) return value;
    value.distance_m = second.mean_m - first.mean_m;
    if (first.count < config.min_points || second.count < config.min_points) return value;
    value.lod95_m = 1.96 * (std::sqrt(first.std_m * first.std_m / first.count +
                                      second.std_m * second.std_m / second.count) +
                            config.registration_error_m);
    value.significant = std::abs(value.distance_m) > value.lod95_m;
    return value;
}

}  // namespace

void M3c2Config::describe(ConfigVisitor& visitor) {
    visitor.enumeration("normals",
                        normals,
                        kM3c2NormalsNames,
                        "direction along which the clouds are compared: vertical = along z, "
                        "pca = along the normal of the reference surface");
    visitor.number("normal_diameter_m",
                   normal_diameter_m,
                   1e-4,
                   100.0,
                   "diameter of the ball whose points define the normal; used if normals is pca");
    visitor.number("projection_diameter_m",
                   projection_diameter_m,
                   1e-4,
                   100.0,
                   "diameter of the cylinder in which the points of each cloud are averaged");
    visitor.number(
        "half_length_m",
        half_length_m,
        1e-4,
        100.0,
        "half the length of the cylinder; a larger distance between the clouds is not found");
    visitor.number("registration_error_m",
                   registration_error_m,
                   0.0,
                   10.0,
                   "one sigma of the registration error of the two clouds; the level of detection "
                   "includes it");
    visitor.integer("min_points",
                    min_points,
                    1,
                    1000000,
                    "smallest number of points that each cloud needs in the cylinder for a "
                    "significant distance");
}

std::vector<M3c2Value> m3c2(const geometry::KdTree& reference,
                            const geometry::KdTree& compared,
                            std::span<const Vector3f> cores_m,
                            const M3c2Config& config,
                            Executor& executor) {
    std::vector<M3c2Value> values(cores_m.size());
    in_pieces(cores_m.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, auto) {
        for (std::size_t i = begin; i < end; ++i)
            values[i] = compare(reference, compared, cores_m[i], config);
    });
    return values;
}

}  // namespace surefoot::eval
