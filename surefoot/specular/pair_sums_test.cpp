// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/pair_sums.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/rng.hpp"

namespace surefoot::specular {
namespace {

/// Random values of any size, with unknown cells.
PatchDetail random_detail(int lines, int line_cells, std::uint64_t seed) {
    Rng rng(seed);
    PatchDetail detail;
    detail.resize(lines, line_cells);
    const int block_cells = line_cells / PatchDetail::kBlocks;
    for (int i = 0; i < lines; ++i) {
        for (int c = 0; c < line_cells; ++c) {
            const bool known = rng.below(5) != 0;
            const auto at = static_cast<std::size_t>(i * line_cells + c);
            detail.values[at] = static_cast<std::int16_t>(known ? rng.normal() * 60.0 : 0.0);
            if (known)
                ++detail
                      .known[static_cast<std::size_t>(i * PatchDetail::kBlocks + c / block_cells)];
        }
    }
    return detail;
}

TEST(PairSums, give_what_the_reference_gives) {
    for (const auto& [lines, cells] : {std::pair{256, 192}, std::pair{128, 96}}) {
        const PatchDetail detail = random_detail(lines, cells, 7);
        for (int twice = 0; twice < 2 * lines; ++twice) {
            for (const int most_apart : {20, 160, 1000}) {
                ASSERT_EQ(pair_sums(detail, twice, most_apart),
                          pair_sums_reference(detail, twice, most_apart))
                    << lines << " lines, mirror line " << twice << ", " << most_apart << " apart";
            }
        }
    }
}

TEST(PairSums, a_line_beyond_the_patch_has_no_pairs) {
    const PatchDetail detail = random_detail(128, 96, 7);
    for (const int twice : {-40, 0, 9, 254, 400}) {
        const PairSums sums = pair_sums(detail, twice, 160);
        EXPECT_EQ(sums, PairSums{}) << twice;
    }
}

}  // namespace
}  // namespace surefoot::specular
