// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/specular/mirror_patch.hpp"

namespace surefoot::specular {

/// Products of the cells that mirror each other about one line, block by block. `pairs` counts the
/// cells that are known on both sides: the smaller count of each pair of blocks.
struct PairSums {
    std::array<std::int32_t, PatchDetail::kBlocks> sum{};
    std::array<std::int32_t, PatchDetail::kBlocks> pairs{};
    friend bool operator==(const PairSums&, const PairSums&) = default;
};

/// Lines nearer to each other than so many cells share grain and blur: their pairs say nothing.
inline constexpr int kLeastApart = 10;

/// Mirror line `twice`: lines i and twice - i mirror each other, so that it lies at line twice / 2.
/// `most_apart`: lines farther from each other do not count. Blocks must be 8 or 16 cells long.
[[nodiscard]] PairSums pair_sums(const PatchDetail& detail, int twice, int most_apart);
/// The same, cell by cell: what `pair_sums` must give.
[[nodiscard]] PairSums pair_sums_reference(const PatchDetail& detail, int twice, int most_apart);

}  // namespace surefoot::specular
