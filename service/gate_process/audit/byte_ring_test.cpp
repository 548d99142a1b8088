// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/byte_ring.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <string>
#include <thread>

#include "surefoot/core/rng.hpp"

namespace surefoot::gate_process {
namespace {

bool push(ByteRing& ring, const std::string& entry) {
    char* at = ring.reserve(entry.size());
    if (at == nullptr) return false;
    std::memcpy(at, entry.data(), entry.size());
    ring.commit();
    return true;
}

std::string random_entry(Rng& rng) {
    return std::string(1 + rng.below(200), static_cast<char>('a' + rng.below(26)));
}

TEST(ByteRing, gives_back_what_a_plain_queue_would) {
    Rng rng(21);
    ByteRing ring(520);
    std::deque<std::string> plain;
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        if (rng.below(2) == 0) {
            const std::string entry = random_entry(rng);
            if (push(ring, entry))
                plain.push_back(entry);
            else
                ++refused;
        } else if (!plain.empty()) {
            ASSERT_EQ(ring.oldest(), plain.front());
            ASSERT_EQ(ring.front(), plain.front());
            ring.pop();
            plain.pop_front();
        }
        ASSERT_EQ(ring.front().empty(), plain.empty());
    }
    EXPECT_GT(refused, 100);
}

TEST(ByteRing, an_empty_ring_takes_every_entry_of_half_its_size) {
    ByteRing ring(1600);
    for (std::size_t size = 1; size <= 792; ++size) {
        ASSERT_TRUE(push(ring, std::string(size, 'x'))) << size;
        ring.pop();
    }
    EXPECT_FALSE(push(ring, std::string(1601, 'x')));
}

TEST(ByteRing, carries_entries_from_one_thread_to_another) {
    ByteRing ring(4096);
    constexpr std::uint64_t kCount = 50'000;
    std::thread reader([&ring] {
        Rng rng(22);
        for (std::uint64_t i = 0; i < kCount;) {
            const std::string_view entry = ring.front();
            if (entry.empty()) {
                std::this_thread::yield();
                continue;
            }
            ASSERT_EQ(entry, random_entry(rng)) << i;
            ring.pop();
            ++i;
        }
    });
    Rng rng(22);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const std::string entry = random_entry(rng);
        while (!push(ring, entry)) std::this_thread::yield();
        static_cast<void>(ring.oldest());
    }
    reader.join();
}

}  // namespace
}  // namespace surefoot::gate_process
