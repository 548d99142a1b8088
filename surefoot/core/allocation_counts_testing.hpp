// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

/// What a test program allocates, where one of its files includes allocations_testing.hpp.
namespace surefoot::heap {

inline std::atomic<std::int64_t> allocations{0};
inline std::atomic<std::int64_t> held_bytes{0};         ///< with what the allocator rounds up to
inline thread_local std::int64_t allocations_here = 0;  ///< of this thread

}  // namespace surefoot::heap
