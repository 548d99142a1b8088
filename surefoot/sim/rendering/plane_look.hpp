// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "surefoot/sim/rendering/ray_batch.hpp"
#include "surefoot/sim/rendering/texture.hpp"

namespace surefoot::sim {

/// A ray in the world that has travelled `way_m` from the camera to `point_m`, with the angle
/// between the rays of neighbouring pixels.
struct Sight {
    Eigen::Vector3d point_m;
    Eigen::Vector3d direction;
    double way_m = 0.0;
    double pixel_angle_rad = 0.0;
};

/// Several rays, stored coordinate by coordinate; filled up to `count`.
struct SightBatch {
    std::size_t count = 0;
    PointBatch points_m;
    RayBatch directions;
    BatchArray<double> way_m;
    BatchArray<double> pixel_angle_rad;

    [[nodiscard]] Sight operator[](std::size_t i) const {
        return {{points_m.x[i], points_m.y[i], points_m.z[i]},
                directions[i],
                way_m[i],
                pixel_angle_rad[i]};
    }
    void add(const Sight& sight) {
        points_m.x[count] = sight.point_m.x();
        points_m.y[count] = sight.point_m.y();
        points_m.z[count] = sight.point_m.z();
        directions.set(count, sight.direction);
        way_m[count] = sight.way_m;
        pixel_angle_rad[count] = sight.pixel_angle_rad;
        ++count;
    }
};

/// How a pattern lies on a plane: texels per metre along its axes in the world, and the offset of
/// its origin.
struct PlaneTexels {
    Eigen::Vector3d texel_u;
    Eigen::Vector3d texel_v;
    Eigen::Vector3d normal;
    double u_texel = 0.0;
    double v_texel = 0.0;
    double texels_per_m = 0.0;
};

/// Lower limit of the cosine of incidence that stretches a footprint: 1.1 deg from grazing.
inline constexpr double kLeastCosine = 0.02;

/// Returns the texture position and the footprint of a ray that hits a plane.
[[nodiscard]] TexelLook look_at(const PlaneTexels& plane, const Sight& sight);
/// Computes the same for a batch, with the same bits on every instruction set.
void look_at(const PlaneTexels& plane, const SightBatch& sights, TextureBatch& out);

}  // namespace surefoot::sim
