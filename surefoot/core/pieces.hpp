// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "surefoot/core/executor.hpp"

namespace surefoot {

/// Returns the number of pieces of `size` elements for `count` elements; the last may be smaller.
[[nodiscard]] constexpr std::size_t pieces_of(std::size_t count, std::size_t size) noexcept {
    return (count + size - 1) / size;
}

/// Calls `work(begin, end, piece)` once for each piece. The pieces do not depend on the number of
/// threads. So a total of sums per piece, added in order of the pieces, is always the same.
template <typename Work>
void in_pieces(std::size_t count, std::size_t size, Executor& executor, const Work& work) {
    executor.parallel_for(static_cast<int>(pieces_of(count, size)), [&](int number) {
        const auto piece = static_cast<std::size_t>(number);
        work(piece * size, std::min((piece + 1) * size, count), piece);
    });
}

}  // namespace surefoot
