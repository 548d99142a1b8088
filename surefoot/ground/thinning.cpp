// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/thinning.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::ground {
namespace {

struct Voxel {
    std::array<std::int64_t, 3> key;
    std::size_t index;
};

std::int64_t key_of(double coordinate_m, double side_m) {
    return saturated_integer<std::int64_t>(std::floor(coordinate_m / side_m));
}

/// Returns the indices of the first point of every voxel, ascending.
std::vector<std::size_t> first_of_each(std::vector<Voxel>& voxels) {
    std::sort(voxels.begin(), voxels.end(), [](const Voxel& a, const Voxel& b) {
        return a.key != b.key ? a.key < b.key : a.index < b.index;
    });
    const auto last = std::unique(voxels.begin(), voxels.end(), [](const Voxel& a, const Voxel& b) {
        return a.key == b.key;
    });
    std::vector<std::size_t> indices;
    indices.reserve(static_cast<std::size_t>(last - voxels.begin()));
    for (auto it = voxels.begin(); it != last; ++it) indices.push_back(it->index);
    std::sort(indices.begin(), indices.end());
    return indices;
}

}  // namespace

std::vector<std::size_t> thin(std::span<const Eigen::Vector3d> points,
                              const Eigen::Vector3d& sensor_origin,
                              double max_range_m,
                              double voxel_m,
                              std::size_t max_points) {
    std::vector<Voxel> voxels;
    voxels.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d p = points[i] - sensor_origin;
        if (!(p.squaredNorm() <= max_range_m * max_range_m)) continue;  // NaN too
        voxels.push_back(
            {{key_of(p.x(), voxel_m), key_of(p.y(), voxel_m), key_of(p.z(), voxel_m)}, i});
    }
    const std::vector<std::size_t> kept = first_of_each(voxels);
    const std::size_t every = std::max<std::size_t>(1, (kept.size() + max_points - 1) / max_points);
    std::vector<std::size_t> result;
    result.reserve(kept.size() / every + 1);
    for (std::size_t i = 0; i < kept.size(); i += every) result.push_back(kept[i]);
    return result;
}

double covered_area_m2(std::span<const Eigen::Vector3d> points,
                       const Eigen::Vector3d& normal,
                       double square_m) {
    const Eigen::Vector3d across = normal.unitOrthogonal();
    const Eigen::Vector3d along = normal.cross(across);
    std::vector<std::array<std::int64_t, 2>> squares;
    squares.reserve(points.size());
    for (const auto& p : points) {
        squares.push_back({key_of(across.dot(p), square_m), key_of(along.dot(p), square_m)});
    }
    std::sort(squares.begin(), squares.end());
    const auto last = std::unique(squares.begin(), squares.end());
    return static_cast<double>(last - squares.begin()) * square_m * square_m;
}

}  // namespace surefoot::ground
