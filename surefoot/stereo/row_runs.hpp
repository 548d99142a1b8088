// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/stereo/match_rows.hpp"

namespace surefoot::stereo {

/// Runs of known pixels of a row whose neighbours differ by at most a limit. The search handles 64
/// pixels at a time, so that the number of runs decides its cost, more than the number of pixels.
class RowRuns {
  public:
    void find(const float* disparity_px, int width, float same_px) {
        const auto words = static_cast<std::size_t>((width + 63) / 64);
        known_.resize(words);
        linked_.resize(words);
        rows::link(disparity_px, width, same_px, known_.data(), linked_.data());
    }

    /// Calls found(first, last) for every run from left to right; `last` is inclusive.
    template <typename Found>
    void for_each(const Found& found) const {
        int first = 0;
        bool open = false;
        std::uint64_t linked_before = 0;  // bit 0: the last pixel of the previous word is linked
        for (std::size_t word = 0; word < known_.size(); ++word) {
            const int column = static_cast<int>(word) * 64;
            std::uint64_t starts = known_[word] & ~(linked_[word] << 1 | linked_before);
            std::uint64_t ends = known_[word] & ~linked_[word];
            linked_before = linked_[word] >> 63;
            for (; ends != 0; ends &= ends - 1) {
                if (!open) {
                    first = column + std::countr_zero(starts);
                    starts &= starts - 1;
                }
                open = false;
                found(first, column + std::countr_zero(ends));
            }
            if (starts == 0) continue;
            first = column + std::countr_zero(starts);
            open = true;
        }
    }

  private:
    // Column u has bit u % 64 of word u / 64.
    std::vector<std::uint64_t> known_;
    std::vector<std::uint64_t> linked_;  ///< pixel pairs that are known and within the limit
};

}  // namespace surefoot::stereo
