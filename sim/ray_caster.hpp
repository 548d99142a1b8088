// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "sim/ray_field.hpp"
#include "sim/scene.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::sim {

/// Rays of one block in the world frame with their nearest hits, row by row, `width` to a row.
struct CastBlock {
    static constexpr std::size_t kPixels =
        static_cast<std::size_t>(RayField::kBlock) * static_cast<std::size_t>(RayField::kBlock);

    int u0 = 0;
    int v0 = 0;
    int width = 0;
    int height = 0;
    std::array<Eigen::Vector3d, kPixels> directions;
    std::array<RayHit, kPixels> hits;
};

/// Casts the rays of a block of pixels against every primitive whose bounding sphere its cone
/// meets.
void cast_block(const Scene& scene,
                const RayField& rays,
                const Pose& T_world_camera,
                int block_x,
                int block_y,
                CastBlock& out);

}  // namespace surefoot::sim
