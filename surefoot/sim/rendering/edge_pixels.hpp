// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "surefoot/core/views.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"

namespace surefoot::sim {

struct Pixel {
    int u = 0;
    int v = 0;
};

/// Finds pixels of a block next to a pixel with another key, row by row; returns their number.
[[nodiscard]] std::size_t find_edge(const Image<std::uint32_t>& key,
                                    int block_x,
                                    int block_y,
                                    std::array<Pixel, CastBlock::kPixels>& out);

/// Casts rays at one sub-pixel position in each of the given pixels of a block, ordered by row.
void cast_within(const Scene& scene,
                 const RayField& rays,
                 const ImageViews& views,
                 const std::array<double, 2>& place,
                 std::span<const Pixel> pixels,
                 CastBlock& block);

}  // namespace surefoot::sim
