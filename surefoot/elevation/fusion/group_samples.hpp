// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace surefoot::elevation {

/// The two passes of `CellGroups::assign` over a block of samples, for every instruction set with
/// the same bytes. Neighbouring pixels fall into the same cell: both work on runs of equal cells.

/// Adds to `count[c]` the number of samples in cell c.
void count_samples(const std::uint32_t* cell, std::size_t samples, std::uint32_t* count);

/// Copies the samples of cell c to `next[c]` and the following places, in order, and moves
/// `next[c]` behind them. Reads z and var, and reads and rewrites their places, up to 16 elements
/// beyond the last one.
struct SamplePlaces {
    std::uint32_t* next = nullptr;
    float* z_m = nullptr;
    float* var_m2 = nullptr;
};
void place_samples(const std::uint32_t* cell,
                   const float* z_m,
                   const float* var_m2,
                   std::size_t samples,
                   const SamplePlaces& to);

}  // namespace surefoot::elevation
