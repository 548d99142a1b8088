// SPDX-License-Identifier: Apache-2.0
// Counts the allocations of a test program by replacing the global operators new and delete. At
// most one file of a program includes this; others include allocation_counts_testing.hpp. All forms
// are replaced: sanitizers reject a free by an operator that did not allocate.
#pragma once

#include <malloc.h>

#include <cstdlib>
#include <new>

#include "surefoot/core/allocation_counts_testing.hpp"

namespace surefoot::heap {

inline void* counted(void* memory) noexcept {
    if (memory == nullptr) return nullptr;
    ++allocations;
    ++allocations_here;
    held_bytes += static_cast<std::int64_t>(malloc_usable_size(memory));
    return memory;
}

inline void* counted_or_throw(void* memory) {
    if (memory == nullptr) throw std::bad_alloc();
    return counted(memory);
}

inline void let_go(void* memory) noexcept {
    held_bytes -= static_cast<std::int64_t>(malloc_usable_size(memory));
    std::free(memory);
}

inline void* bytes(std::size_t size) noexcept {
    return std::malloc(size == 0 ? 1 : size);
}

inline void* bytes(std::size_t size, std::align_val_t alignment) noexcept {
    const auto align = static_cast<std::size_t>(alignment);
    return std::aligned_alloc(align, (size + align) / align * align);
}

}  // namespace surefoot::heap

// Not inlined: otherwise the compiler reports malloc and delete as a mismatched pair.
// NOLINTBEGIN(misc-definitions-in-headers): one file of a program has them.
[[gnu::noinline]] void* operator new(std::size_t size) {
    return surefoot::heap::counted_or_throw(surefoot::heap::bytes(size));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    return surefoot::heap::counted_or_throw(surefoot::heap::bytes(size, alignment));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return surefoot::heap::counted(surefoot::heap::bytes(size));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    surefoot::heap::let_go(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    surefoot::heap::let_go(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
    surefoot::heap::let_go(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
    surefoot::heap::let_go(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    surefoot::heap::let_go(memory);
}
// NOLINTEND(misc-definitions-in-headers)
