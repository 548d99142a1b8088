// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "surefoot/sim/rendering/ray_field.hpp"
#include "surefoot/sim/rendering/shutter.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// World-frame rays of one block and their nearest hits, row by row, `width` rays a row. Reused
/// from block to block, so that filling it does not allocate.
struct CastBlock {
    static constexpr std::size_t kPixels = kBatchRays;
    static_assert(kPixels == static_cast<std::size_t>(RayField::kBlock * RayField::kBlock));

    int u0 = 0;
    int v0 = 0;
    int width = 0;
    int height = 0;
    RayBatch directions;
    HitBatch hits;
    [[nodiscard]] std::size_t pixels() const noexcept {
        return static_cast<std::size_t>(width * height);
    }
    std::vector<int> primitives;     ///< candidates for the first hit of a ray through the block
    std::optional<FacePlane> plane;  ///< plane of the face that all rays provably meet first
};

/// Finds position and size of a block, and the primitives that its pixels may hit during the
/// exposure of its rows. Sets the plane if all rays provably meet one plane face.
void find_primitives(const Scene& scene,
                     const RayField& rays,
                     const ImageViews& views,
                     int block_x,
                     int block_y,
                     CastBlock& out);

/// Calls find_primitives, then casts the rays of the block against the primitives found.
void cast_block(const Scene& scene,
                const RayField& rays,
                const ImageViews& views,
                int block_x,
                int block_y,
                CastBlock& out);

}  // namespace surefoot::sim
