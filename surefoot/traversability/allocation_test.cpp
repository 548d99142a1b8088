// SPDX-License-Identifier: Apache-2.0
// Counts every allocation of this test program, to prove that rating a map needs none after the
// first.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "surefoot/traversability/traversability.hpp"

namespace {
std::atomic<long> allocations{0};
}

// Not inlined, or the compiler takes malloc and delete for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto align = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(align, (size + align) / align * align)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace surefoot::traversability {
namespace {

TEST(TraversabilityAllocation, NoneAfterTheFirstMap) {
    const grid::Layer map(120, 100, 0.25F);
    Serial serial;
    Traversability rater{TraversabilityConfig{}};
    TraversabilityLayers layers;
    rater.rate(map.view(), 0.025, serial, layers);
    const long before = allocations;
    rater.rate(map.view(), 0.025, serial, layers);
    rater.rate(map.view(), 0.025, CellRect{10, 10, 30, 30}, serial, layers);
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(before, 0) << "the counter works";
}

}  // namespace
}  // namespace surefoot::traversability
