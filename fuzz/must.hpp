// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace surefoot {

/// Ends a fuzz target with a finding where what it says at its head does not hold.
inline void must(bool holds) {
    if (!holds) std::abort();
}

}  // namespace surefoot
