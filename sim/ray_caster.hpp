// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/ray_field.hpp"
#include "sim/scene.hpp"
#include "sim/shutter.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// Rays of one block in the world frame with their nearest hits, row by row, `width` to a row. Kept
/// from block to block: it is filled without allocating.
struct CastBlock {
    static constexpr std::size_t kPixels =
        static_cast<std::size_t>(RayField::kBlock) * static_cast<std::size_t>(RayField::kBlock);

    int u0 = 0;
    int v0 = 0;
    int width = 0;
    int height = 0;
    std::array<Eigen::Vector3d, kPixels> directions;
    std::array<RayHit, kPixels> hits;
    std::vector<int> primitives;  ///< that some ray through a pixel of the block may meet
};

/// The plane that a block of pixels and the eight blocks round it show, and nothing else.
struct BlockPlane {
    int face = -1;  ///< -1: more than one surface, or a curved one
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    double nearest_m = 0.0;  ///< depth of the block
};

/// Those planes for all blocks, row by row, from an image of surfaces and depths.
[[nodiscard]] std::vector<BlockPlane> find_planes(const Scene& scene,
                                                  const RayField& rays,
                                                  const ImageViews& views,
                                                  const Image<std::int16_t>& surface,
                                                  const Image<float>& depth_m);

/// Casts the rays of a block against its plane alone. False, without a result, where the camera has
/// moved so far between `before` (which the plane was found with) and `now` that something else
/// may have come into the block.
[[nodiscard]] bool cast_on_plane(const Scene& scene,
                                 const RayField& rays,
                                 const ImageViews& before,
                                 const ImageViews& now,
                                 const BlockPlane& plane,
                                 int block_x,
                                 int block_y,
                                 CastBlock& out);

/// Place and size of a block, and the primitives whose bounding sphere the cone round its pixels
/// meets while its rows are exposed.
void find_primitives(const Scene& scene,
                     const RayField& rays,
                     const ImageViews& views,
                     int block_x,
                     int block_y,
                     CastBlock& out);

/// Casts the rays of a block of pixels against those primitives.
void cast_block(const Scene& scene,
                const RayField& rays,
                const ImageViews& views,
                int block_x,
                int block_y,
                CastBlock& out);

}  // namespace surefoot::sim
