// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/foot_ground.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

/// Fits a least-squares plane to points on a lattice. The plane is level for fewer than three
/// points or for collinear points.
LevelPlane fit(const std::vector<SolePoint>& points, double mean_z_m) {
    Vector2d middle = Vector2d::Zero();
    for (const SolePoint& p : points) middle += p.p_foot_m;
    middle /= static_cast<double>(points.size());
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double xz = 0.0;
    double yz = 0.0;
    for (const SolePoint& p : points) {
        const Vector2d d = p.p_foot_m - middle;
        const double dz = p.z_m - mean_z_m;
        xx += d.x() * d.x();
        xy += d.x() * d.y();
        yy += d.y() * d.y();
        xz += d.x() * dz;
        yz += d.y() * dz;
    }
    const double determinant = xx * yy - xy * xy;
    // Limit of the relative determinant; points on a line stay below it.
    constexpr double kDegenerate = 1e-9;
    if (!(determinant > kDegenerate * xx * yy)) return {mean_z_m, Vector2d::Zero()};
    const Vector2d slope((yy * xz - xy * yz) / determinant, (xx * yz - xy * xz) / determinant);
    return {mean_z_m - slope.dot(middle), slope};
}

int patches_along(double length_m, double side_m) {
    return std::max(1, saturated_integer<int>(std::ceil(length_m / side_m - 1e-9)));
}

}  // namespace

double FootGround::tilt_rad() const {
    return std::atan(plane.slope.norm());
}

FootGround::Patch FootGround::worst_patch(const Vector2d& size_m, double side_m) const {
    struct Sum {
        double residual_m = 0.0;
        Vector2d p_field_m = Vector2d::Zero();
        int count = 0;
    };
    const int nx = patches_along(size_m.x(), side_m);
    const int ny = patches_along(size_m.y(), side_m);
    std::vector<Sum> sums(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
    for (const SolePoint& p : points) {
        const Vector2d share = p.p_foot_m.cwiseQuotient(size_m).array() + 0.5;
        const int ix = clamped_integer<int>(share.x() * nx, 0, nx - 1);
        const int iy = clamped_integer<int>(share.y() * ny, 0, ny - 1);
        Sum& sum = sums[static_cast<std::size_t>(iy * nx + ix)];
        sum.residual_m += p.z_m - plane.at(p.p_foot_m);
        sum.p_field_m += p.p_field_m;
        ++sum.count;
    }
    Patch worst;
    for (const Sum& sum : sums) {
        if (sum.count == 0) continue;
        const double residual_m = std::abs(sum.residual_m) / sum.count;
        if (residual_m > worst.residual_m) worst = {residual_m, sum.p_field_m / sum.count};
    }
    return worst;
}

FootGround ground_under(const GroundField& field,
                        const Rect& foot,
                        const PlanarPose& T_field_body) {
    FootGround under;
    const Vector2d middle = 0.5 * (foot.min_m + foot.max_m);
    const Vector2d samples = (foot.max_m - foot.min_m) / GroundField::kSpacing_m;
    under.points.reserve(saturated_integer<std::size_t>((samples.x() + 2.0) * (samples.y() + 2.0)));
    double sum_m = 0.0;
    for_samples_under(
        field, foot, T_field_body, [&](int i, int j, const Vector2d& p_field, const Vector2d& p) {
            const double z_m = field.at(i, j).ground_m;
            if (std::isnan(z_m)) {
                under.void_at_m = p_field;
                return;
            }
            under.points.push_back({i, j, p_field, p - middle, z_m});
            sum_m += z_m;
        });
    if (under.points.empty()) return under;
    under.mean_z_m = sum_m / static_cast<double>(under.points.size());
    under.plane = fit(under.points, under.mean_z_m);
    return under;
}

}  // namespace surefoot::sim
