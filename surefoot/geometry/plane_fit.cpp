// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/plane_fit.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/geometry/symmetric3.hpp"

namespace surefoot::geometry {
namespace {

constexpr double kCollinearRatio = 1e-12;  // limit of a ratio of variances, 1e-6 for lengths

/// `point_at(i)` returns point i, for i in [0, count).
template <typename PointAt>
std::optional<PlaneFit> fit(std::size_t count, const PointAt& point_at) {
    PlaneFit result;
    for (std::size_t i = 0; i < count; ++i) {
        if (!point_at(i).allFinite()) continue;
        result.centroid_m += point_at(i);
        ++result.count;
    }
    if (result.count < 3) return std::nullopt;
    result.centroid_m /= result.count;

    // The second pass computes relative to the centroid: coordinates may be large (maps, UTM).
    Symmetric3 scatter;
    for (std::size_t i = 0; i < count; ++i) {
        if (!point_at(i).allFinite()) continue;
        const Eigen::Vector3d d = point_at(i) - result.centroid_m;
        scatter.xx += d.x() * d.x();
        scatter.xy += d.x() * d.y();
        scatter.xz += d.x() * d.z();
        scatter.yy += d.y() * d.y();
        scatter.yz += d.y() * d.z();
        scatter.zz += d.z() * d.z();
    }
    const EigenSystem3 system = eigen_system(scatter);
    if (!(system.values[1] > kCollinearRatio * system.values[2])) return std::nullopt;

    const auto sigma_m = [&](double sum) { return std::sqrt(std::max(sum, 0.0) / result.count); };
    result.rms_m = sigma_m(system.values[0]);
    result.narrow_sigma_m = sigma_m(system.values[1]);
    result.wide_sigma_m = sigma_m(system.values[2]);
    const Eigen::Vector3d normal = system.vectors.col(0);
    result.plane = Plane{normal, -normal.dot(result.centroid_m)}.facing(Eigen::Vector3d::UnitZ());
    return result;
}

}  // namespace

std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points) {
    return fit(points.size(), [&](std::size_t i) -> const Eigen::Vector3d& { return points[i]; });
}

std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points,
                                  std::span<const int> indices) {
    return fit(indices.size(), [&](std::size_t i) -> const Eigen::Vector3d& {
        return points[static_cast<std::size_t>(indices[i])];
    });
}

}  // namespace surefoot::geometry
