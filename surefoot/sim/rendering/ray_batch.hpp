// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>

namespace surefoot::sim {

/// Nearest hit so far along one ray. Faces are numbered through the whole scene.
struct RayHit {
    double distance_m = std::numeric_limits<double>::infinity();
    int face = -1;
};

/// Number of rays of a block of pixels. A batch stores them coordinate by coordinate for SIMD. Only
/// the entries that are read are filled.
inline constexpr std::size_t kBatchRays = 256;
template <typename T>
using BatchArray = std::array<T, kBatchRays>;

/// Unit direction vectors.
struct RayBatch {
    BatchArray<double> x;
    BatchArray<double> y;
    BatchArray<double> z;

    [[nodiscard]] Eigen::Vector3d operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Eigen::Vector3d& direction) {
        x[i] = direction.x();
        y[i] = direction.y();
        z[i] = direction.z();
    }
};

struct HitBatch {
    BatchArray<double> distance_m;
    BatchArray<int> face;

    [[nodiscard]] RayHit operator[](std::size_t i) const { return {distance_m[i], face[i]}; }
    void set(std::size_t i, const RayHit& hit) {
        distance_m[i] = hit.distance_m;
        face[i] = hit.face;
    }
};

/// Rays [first, end) of a batch.
struct BatchRange {
    std::size_t first = 0;
    std::size_t end = 0;
};

/// A side of a convex solid, relative to the origin of a ray. The solid lies behind the side; the
/// origin lies `outside_m` in front of it (negative: behind it).
struct FacingSide {
    Eigen::Vector3d normal;
    double outside_m = 0.0;
    int face = 0;
};

// Each function handles many rays at once. On every instruction set it gives the same bits as plain
// code that handles one ray.

/// Directions from an optical frame into the world: R_world_camera * (x, y, z)[i] for the rays
/// [range.first, range.end). Element 0 of `x`, `y` and `z` belongs to ray 0.
void turn_rays(const Eigen::Matrix3d& R_world_camera,
               const double* x,
               const double* y,
               const double* z,
               BatchRange range,
               RayBatch& out);

/// Computes the hits on a plane that all rays meet first, `above_m` below the origin. A NaN ray
/// (beyond the rim of a fisheye image) hits nothing.
void meet_plane(const Eigen::Vector3d& normal,
                double above_m,
                int face,
                const RayBatch& rays,
                BatchRange range,
                HitBatch& hits);

/// Batch of `Prism::intersect`; the first `towards` of the `count` sides face the origin.
void meet_convex(const FacingSide* sides,
                 std::size_t towards,
                 std::size_t count,
                 const RayBatch& rays,
                 BatchRange range,
                 HitBatch& hits);

/// End points of rays: origin + distance * direction.
struct PointBatch {
    BatchArray<double> x;
    BatchArray<double> y;
    BatchArray<double> z;
};
void end_points(const Eigen::Vector3d& origin_m,
                const RayBatch& rays,
                const HitBatch& hits,
                BatchRange range,
                PointBatch& out);

}  // namespace surefoot::sim
