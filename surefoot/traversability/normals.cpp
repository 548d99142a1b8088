// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/normals.hpp"

#include <cmath>

#include "surefoot/core/unknown.hpp"
#include "surefoot/geometry/symmetric3.hpp"

namespace surefoot::traversability {
namespace {

/// Sums over the known cells of a disc, in metres relative to the centre cell and its height. All
/// terms have the size of the disc, so subtracting the mean loses no precision.
struct Moments {
    double n = 0.0;
    double x = 0.0, y = 0.0, z = 0.0;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    double xz = 0.0, yz = 0.0, zz = 0.0;

    [[nodiscard]] geometry::Symmetric3 covariance_m2() const noexcept {
        const double inverse = 1.0 / n;
        const double mx = x * inverse, my = y * inverse, mz = z * inverse;
        return {xx * inverse - mx * mx,
                xy * inverse - mx * my,
                xz * inverse - mx * mz,
                yy * inverse - my * my,
                yz * inverse - my * mz,
                zz * inverse - mz * mz};
    }
};

Moments moments(const float* center, const Disc& disc) noexcept {
    const double center_m = static_cast<double>(*center);
    Moments sum;
    for (const DiscCell& cell : disc.cells) {
        const float height_m = center[cell.offset];
        if (std::isnan(height_m)) continue;
        const double z_m = static_cast<double>(height_m) - center_m;
        sum.n += 1.0;
        sum.x += cell.x_m;
        sum.y += cell.y_m;
        sum.z += z_m;
        sum.xx += cell.x_m * cell.x_m;
        sum.xy += cell.x_m * cell.y_m;
        sum.yy += cell.y_m * cell.y_m;
        sum.xz += cell.x_m * z_m;
        sum.yz += cell.y_m * z_m;
        sum.zz += z_m * z_m;
    }
    return sum;
}

Eigen::Vector3d normal_at(const float* center, const Disc& disc) noexcept {
    if (std::isnan(*center) || disc.cells.size() < 2) return Eigen::Vector3d::Constant(kNan);
    const Moments sum = moments(center, disc);
    if (sum.n < 3.0) return Eigen::Vector3d::UnitZ();
    const geometry::SmallestAxis axis = geometry::smallest_axis(sum.covariance_m2());
    if (!(axis.middle > kMinMiddleVariance_m2)) return Eigen::Vector3d::UnitZ();
    return axis.direction.z() < 0.0 ? Eigen::Vector3d(-axis.direction) : axis.direction;
}

}  // namespace

Normal plain_normal(const float* center, const Disc& disc) noexcept {
    const Eigen::Vector3d normal = normal_at(center, disc);
    return {static_cast<float>(normal.x()),
            static_cast<float>(normal.y()),
            static_cast<float>(normal.z())};
}

void normals(const PaddedLayer& height_m,
             const Disc& disc,
             const CellRect& rect,
             grid::Layer& normal_x,
             grid::Layer& normal_y,
             grid::Layer& normal_z) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            const Normal normal = plain_normal(height_m.cell(ix, iy), disc);
            normal_x.row(iy)[ix] = normal.x;
            normal_y.row(iy)[ix] = normal.y;
            normal_z.row(iy)[ix] = normal.z;
        }
    }
}

}  // namespace surefoot::traversability
