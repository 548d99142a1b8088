// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/edge_pixels.hpp"

#include <algorithm>

namespace surefoot::sim {
namespace {

bool on_edge(const Image<std::uint32_t>& key, int u, int v) {
    const std::uint32_t here = key.row(v)[u];
    return (u > 0 && key.row(v)[u - 1] != here) ||
           (u + 1 < key.width() && key.row(v)[u + 1] != here) ||
           (v > 0 && key.row(v - 1)[u] != here) ||
           (v + 1 < key.height() && key.row(v + 1)[u] != here);
}

}  // namespace

std::size_t find_edge(const Image<std::uint32_t>& key,
                      int block_x,
                      int block_y,
                      std::array<Pixel, CastBlock::kPixels>& out) {
    std::size_t count = 0;
    const int u_end = std::min((block_x + 1) * RayField::kBlock, key.width());
    const int v_end = std::min((block_y + 1) * RayField::kBlock, key.height());
    for (int v = block_y * RayField::kBlock; v < v_end; ++v) {
        for (int u = block_x * RayField::kBlock; u < u_end; ++u) {
            if (on_edge(key, u, v)) out[count++] = {u, v};
        }
    }
    return count;
}

void cast_within(const Scene& scene,
                 const RayField& rays,
                 const ImageViews& views,
                 const std::array<double, 2>& place,
                 std::span<const Pixel> pixels,
                 CastBlock& block) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto [u, v] = pixels[i];
        block.directions.set(
            i, views.row(v).R_world_camera * rays.ray_within(u, v, place[0], place[1]));
        block.hits.set(i, {});
    }
    for (std::size_t first = 0; first < pixels.size();) {
        // Rows that share their view are cast at once.
        std::size_t end = first + 1;
        while (end < pixels.size() && (views.single() || pixels[end].v == pixels[first].v)) ++end;
        for (const int k : block.primitives) {
            scene.intersect_primitive(
                k, views.row(pixels[first].v).origin_m, block.directions, {first, end}, block.hits);
        }
        first = end;
    }
}

}  // namespace surefoot::sim
