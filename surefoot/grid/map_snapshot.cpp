// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/map_snapshot.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "surefoot/grid/snapshot_fields.hpp"

namespace surefoot::grid {
namespace {

constexpr std::uint64_t kOffsetBasis = 0xcbf29ce484222325ULL;
constexpr std::uint64_t kPrime = 0x00000100000001b3ULL;

constexpr std::uint64_t step(std::uint64_t hash, std::uint64_t word) noexcept {
    return (hash ^ word) * kPrime;
}

std::uint64_t word_at(const unsigned char* bytes) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof(word));
    return word;
}

/// Hashes `count` elements from `first`. Four independent chains keep the multiplier busy: a single
/// chain waits for every product. Uses plain variables, because the compiler would keep an array of
/// lanes in memory.
template <typename Layer>
std::uint64_t add_part(std::uint64_t hash,
                       const Layer& layer,
                       std::size_t first,
                       std::size_t count) noexcept {
    constexpr std::size_t kWord = sizeof(std::uint64_t);
    constexpr std::size_t kElement = sizeof(typename Layer::value_type);
    std::uint64_t a = hash;
    std::uint64_t b = hash ^ 1U;
    std::uint64_t c = hash ^ 2U;
    std::uint64_t d = hash ^ 3U;
    const auto* bytes = reinterpret_cast<const unsigned char*>(layer.data()) + first * kElement;
    for (const auto* const end = bytes + count * kElement; bytes != end; bytes += 4 * kWord) {
        a = step(a, word_at(bytes));
        b = step(b, word_at(bytes + kWord));
        c = step(c, word_at(bytes + 2 * kWord));
        d = step(d, word_at(bytes + 3 * kWord));
    }
    return step(step(step(step(hash, a), b), c), d);
}

template <typename Layer>
std::uint64_t add_whole(std::uint64_t hash, const Layer& layer) noexcept {
    static_assert(sizeof(Layer) % (4 * sizeof(std::uint64_t)) == 0);
    return add_part(hash, layer, 0, layer.size());
}

std::uint64_t block_checksum(const MapSnapshot& s, std::size_t block) noexcept {
    constexpr std::size_t kCells = MapSnapshot::kBlockCells;
    static_assert(kCells % (4 * sizeof(std::uint64_t)) == 0,
                  "the narrowest layer must fill whole groups of four words in a block");
    std::uint64_t hash = step(kOffsetBasis, block);
    for_each_snapshot_layer(s, [&hash, first = block * kCells](const auto& layer) {
        hash = add_part(hash, layer, first, kCells);
    });
    return hash;
}

bool are_blocks_intact(const MapSnapshot& s, std::size_t first, std::size_t last) noexcept {
    for (std::size_t block = first; block <= last; ++block) {
        if (s.block_checksum[block] != block_checksum(s, block)) return false;
    }
    return true;
}

std::uint64_t header_hash(const MapSnapshot& s) noexcept {
    std::uint64_t hash = kOffsetBasis;
    const auto add = [&hash](const char*, auto value) {
        if constexpr (std::is_floating_point_v<decltype(value)>)
            hash = step(hash, std::bit_cast<std::uint64_t>(value));
        else
            hash = step(hash, static_cast<std::uint64_t>(value));
    };
    add("magic", s.magic);
    add("layout", s.layout);
    for_each_header_field(s, add);
    for (const std::uint8_t byte : s.padding) add("padding", byte);
    return hash;
}

std::uint64_t top_checksum(const MapSnapshot& s) noexcept {
    return add_whole(add_whole(header_hash(s), s.edges), s.block_checksum);
}

bool has_sound_header(const MapSnapshot& s) noexcept {
    // The rules of the gate are valid for cells of 5 mm to 0.2 m.
    constexpr std::int32_t kFinestTenthMm = 50;
    constexpr std::int32_t kCoarsestTenthMm = 2000;
    // Within 100 km no product of quantised coordinates overflows.
    constexpr std::int64_t kFarthestTenthMm = 1'000'000'000;
    const auto near = [](std::int64_t value) {
        return value >= -kFarthestTenthMm && value <= kFarthestTenthMm;
    };
    const double norm_sq =
        s.body_cos_yaw * s.body_cos_yaw + s.body_sin_yaw * s.body_sin_yaw;  // NaN fails this test
    return s.magic == MapSnapshot::kMagic && s.layout == MapSnapshot::kLayout && s.nx >= 1 &&
           s.nx <= MapSnapshot::kMaxSide && s.ny >= 1 && s.ny <= MapSnapshot::kMaxSide &&
           s.edge_count >= 0 && s.edge_count <= MapSnapshot::kMaxEdges &&
           s.resolution_tenth_mm >= kFinestTenthMm && s.resolution_tenth_mm <= kCoarsestTenthMm &&
           near(s.origin_x_tenth_mm) && near(s.origin_y_tenth_mm) && near(s.body_x_tenth_mm) &&
           near(s.body_y_tenth_mm) && near(s.body_z_tenth_mm) && norm_sq > 0.999 && norm_sq < 1.001;
}

}  // namespace

void seal(MapSnapshot& snapshot) noexcept {
    for (std::size_t block = 0; block < snapshot.block_checksum.size(); ++block)
        snapshot.block_checksum[block] = block_checksum(snapshot, block);
    snapshot.checksum = top_checksum(snapshot);
}

bool is_sealed(const MapSnapshot& snapshot) noexcept {
    return has_sound_header(snapshot) && snapshot.checksum == top_checksum(snapshot);
}

bool are_rows_intact(const MapSnapshot& snapshot,
                     std::int64_t first_row,
                     std::int64_t last_row) noexcept {
    first_row = std::max<std::int64_t>(first_row, 0);
    last_row = std::min<std::int64_t>(last_row, snapshot.ny - 1);
    if (first_row > last_row) return true;
    const auto block_of = [](std::int64_t cell) {
        return static_cast<std::size_t>(cell / MapSnapshot::kBlockCells);
    };
    return are_blocks_intact(
        snapshot, block_of(first_row * snapshot.nx), block_of((last_row + 1) * snapshot.nx - 1));
}

bool is_intact(const MapSnapshot& snapshot) noexcept {
    return is_sealed(snapshot) && are_blocks_intact(snapshot, 0, MapSnapshot::kBlocks - 1);
}

}  // namespace surefoot::grid
