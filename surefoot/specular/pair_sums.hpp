// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/specular/mirror_patch.hpp"

namespace surefoot::specular {

/// Sums of products of the cells that mirror each other about one line, per block. `pairs`: smaller
/// number of known cells of the two mirrored blocks, summed over the lines.
struct PairSums {
    std::array<std::int32_t, PatchDetail::kBlocks> sum{};
    std::array<std::int32_t, PatchDetail::kBlocks> pairs{};
    friend bool operator==(const PairSums&, const PairSums&) = default;
};

/// Lines nearer to each other than this share grain and blur, so their pairs do not count.
inline constexpr int kLeastApart = 10;

/// Computes the sums for mirror line `twice`: lines i and twice - i mirror about line twice / 2.
/// Lines farther apart than `most_apart` do not count. Blocks must be 8 or 16 cells long.
[[nodiscard]] PairSums pair_sums(const PatchDetail& detail, int twice, int most_apart);
/// Reference implementation of `pair_sums`, cell by cell, with the same result.
[[nodiscard]] PairSums pair_sums_reference(const PatchDetail& detail, int twice, int most_apart);

}  // namespace surefoot::specular
