// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "surefoot/core/executor.hpp"

namespace surefoot::stereo {

/// Calls work(first, last) for blocks of rows, `last` exclusive. The block borders, and so the
/// results, do not depend on the number of threads.
template <int kBlockRows = 32, typename Work>
void for_row_blocks(Executor& executor, int height, const Work& work) {
    const int blocks = (height + kBlockRows - 1) / kBlockRows;
    executor.parallel_for(blocks, [&](int block) {
        work(block * kBlockRows, std::min(height, (block + 1) * kBlockRows));
    });
}

}  // namespace surefoot::stereo
