// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

/// Memory counters of a test program. One of its files must include allocations_testing.hpp.
namespace surefoot::heap {

inline std::atomic<std::int64_t> allocations{0};
inline std::atomic<std::int64_t> held_bytes{0};         ///< includes the allocator's round-up
inline thread_local std::int64_t allocations_here = 0;  ///< by the current thread

}  // namespace surefoot::heap
