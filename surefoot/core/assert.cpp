// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace surefoot::detail {

void assertion_failed(const char* condition, const char* file, int line) noexcept {
    std::fprintf(stderr, "surefoot: broken invariant '%s' at %s:%d\n", condition, file, line);
    std::abort();
}

}  // namespace surefoot::detail
