// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace surefoot::elevation {

/// The two passes of `CellGroups::assign` over a block of samples. Every instruction set gives the
/// same bytes. Neighbouring pixels often share a cell, so both passes work on runs of equal cells.

/// Adds to `count[c]` the number of samples in cell c.
void count_samples(const std::uint32_t* cell, std::size_t samples, std::uint32_t* count);

/// Copies the samples of cell c, in order, to index `next[c]` and the following indices. Then sets
/// `next[c]` to the index after the last copy. Reads the inputs, and reads and rewrites the
/// outputs, up to 16 elements beyond the last one.
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
