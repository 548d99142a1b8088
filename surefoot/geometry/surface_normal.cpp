// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/surface_normal.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/geometry/symmetric3.hpp"

namespace surefoot::geometry {
namespace {

/// Sums over points, relative to the middle of the ball.
struct Sums {
    double count = 0.0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Symmetric3 second;

    void add(const Eigen::Vector3d& d, double copies = 1.0) {
        const Eigen::Vector3d all = copies * d;
        count += copies;
        first += all;
        second.xx += all.x() * d.x();
        second.xy += all.x() * d.y();
        second.xz += all.x() * d.z();
        second.yy += all.y() * d.y();
        second.yz += all.y() * d.z();
        second.zz += all.z() * d.z();
    }
    [[nodiscard]] Symmetric3 covariance() const {
        const double n = count;
        const Eigen::Vector3d m = first / n;
        return {second.xx / n - m.x() * m.x(),
                second.xy / n - m.x() * m.y(),
                second.xz / n - m.x() * m.z(),
                second.yy / n - m.y() * m.y(),
                second.yz / n - m.y() * m.z(),
                second.zz / n - m.z() * m.z()};
    }
};

/// `sq_radius_m2`: squared radius of the ball, or squared distance of the farthest point.
std::optional<LocalSurface> surface_of(const Sums& sums, double sq_radius_m2) {
    if (sums.count < 3.0) return std::nullopt;
    const SmallestAxis thin = smallest_axis(sums.covariance());
    // Same limit as in plane_fit: points within a millionth of the ball from a line span no
    // surface.
    constexpr double kLine = 1e-6;
    if (!(thin.middle > kLine * kLine * sq_radius_m2)) return std::nullopt;
    Eigen::Vector3d normal = thin.direction;
    // A wall that is vertical within rounding has no meaningful upper side. The component x or y
    // with the larger magnitude then becomes positive.
    constexpr double kUpright = 1e-6;
    const double side = std::abs(normal.z()) > kUpright               ? normal.z()
                        : std::abs(normal.x()) > std::abs(normal.y()) ? normal.x()
                                                                      : normal.y();
    if (side < 0.0) normal = -normal;
    return LocalSurface{normal.cast<float>().normalized(),
                        static_cast<float>(std::sqrt(std::max(thin.smallest, 0.0)))};
}

}  // namespace

std::optional<Eigen::Vector3f> surface_normal(const KdTree& cloud,
                                              const Eigen::Vector3f& middle_m,
                                              float radius_m) {
    const Eigen::Vector3d from_m = middle_m.cast<double>();
    const double sq_radius_m2 = static_cast<double>(radius_m) * static_cast<double>(radius_m);
    Sums sums;
    const auto add = [&](std::span<const Eigen::Vector3f> run, std::size_t copies) {
        for (const Eigen::Vector3f& p_m : run) {
            const Eigen::Vector3d to_m = p_m.cast<double>() - from_m;
            if (to_m.squaredNorm() <= sq_radius_m2) sums.add(to_m, static_cast<double>(copies));
        }
    };
    cloud.runs_near_ball(middle_m, radius_m, add);
    const auto surface = surface_of(sums, sq_radius_m2);
    return surface ? std::optional(surface->normal) : std::nullopt;
}

std::optional<LocalSurface> surface_of_neighbours(const KdTree& cloud,
                                                  const Eigen::Vector3f& middle_m,
                                                  std::span<const Neighbour> near) {
    const Eigen::Vector3d from_m = middle_m.cast<double>();
    Sums sums;
    double sq_radius_m2 = 0.0;
    for (const Neighbour& neighbour : near) {
        sums.add(cloud.points_m()[neighbour.index].cast<double>() - from_m);
        sq_radius_m2 = std::max(sq_radius_m2, static_cast<double>(neighbour.sq_distance_m2));
    }
    return surface_of(sums, sq_radius_m2);
}

}  // namespace surefoot::geometry
