// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/memory_checksum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace surefoot::gate_process {
namespace {

constexpr ChecksumKey kKey{0x0706050403020100ULL, 0x0f0e0d0c0b0a0908ULL};

std::vector<unsigned char> message_of(std::size_t size) {
    std::vector<unsigned char> message(size);
    for (std::size_t i = 0; i < size; ++i)
        message[i] = static_cast<unsigned char>(31 * i + i / 256);
    return message;
}

std::uint64_t checksum_of(std::initializer_list<std::uint64_t> numbers) {
    KeyedChecksum checksum(kKey);
    for (const std::uint64_t number : numbers) checksum.add(number);
    return checksum.finish();
}

/// A product of 64 x 64 bits in halves of 32 bits, as on paper: {high, low}.
std::pair<std::uint64_t, std::uint64_t> product(std::uint64_t a, std::uint64_t b) {
    const std::uint64_t mask = 0xffffffffULL;
    const std::uint64_t low = (a & mask) * (b & mask);
    const std::uint64_t middle = (a >> 32U) * (b & mask) + (low >> 32U);
    const std::uint64_t other = (a & mask) * (b >> 32U) + (middle & mask);
    return {(a >> 32U) * (b >> 32U) + (middle >> 32U) + (other >> 32U),
            other << 32U | (low & mask)};
}

/// The definition in plain code, byte by byte.
std::uint64_t plain_checksum(std::initializer_list<std::uint64_t> labels,
                             const std::vector<unsigned char>& message) {
    std::vector<unsigned char> padded = message;
    padded.resize((padded.size() + 1023) / 1024 * 1024);
    const auto word = [&](std::size_t index) {
        std::uint64_t value = 0;
        for (std::size_t i = 8; i > 0; --i) value = value << 8U | padded[8 * index + i - 1];
        return value;
    };
    KeyedChecksum checksum(kKey);
    checksum.add(102);
    for (const std::uint64_t label : labels) checksum.add(label);
    checksum.add(message.size());
    for (std::size_t block = 0; block < padded.size() / 1024; ++block) {
        std::uint64_t high = 0;
        std::uint64_t low = 0;
        for (std::uint64_t i = 0; i < 128; i += 2) {
            const auto [h, l] = product(word(128 * block + i) + checksum_of({101, i}),
                                        word(128 * block + i + 1) + checksum_of({101, i + 1}));
            low += l;
            high += h + (low < l ? 1U : 0U);
        }
        checksum.add(low);
        checksum.add(high);
    }
    return checksum.finish();
}

TEST(MemoryChecksum, is_its_definition) {
    for (const std::size_t size : {0U, 1U, 8U, 16U, 1023U, 1024U, 1025U, 5000U})
        EXPECT_EQ(memory_checksum(kKey, {1, 2, 3}, message_of(size)),
                  plain_checksum({1, 2, 3}, message_of(size)))
            << size;
}

TEST(MemoryChecksum, every_flipped_bit_gives_another) {
    std::vector<unsigned char> message = message_of(1500);
    std::set<std::uint64_t> found{memory_checksum(kKey, {7}, message)};
    for (std::size_t bit = 0; bit < 8 * message.size(); ++bit) {
        message[bit / 8] = static_cast<unsigned char>(message[bit / 8] ^ 1U << bit % 8);
        EXPECT_TRUE(found.insert(memory_checksum(kKey, {7}, message)).second) << bit;
        message[bit / 8] = static_cast<unsigned char>(message[bit / 8] ^ 1U << bit % 8);
    }
}

TEST(MemoryChecksum, key_labels_length_and_order_count) {
    const std::vector<unsigned char> message = message_of(3000);
    std::vector<unsigned char> longer = message;
    longer.push_back(0);
    std::vector<unsigned char> swapped = message;  // two whole blocks
    std::swap_ranges(swapped.begin(), swapped.begin() + 1024, swapped.begin() + 1024);
    const std::set<std::uint64_t> all{memory_checksum(kKey, {1, 2}, message),
                                      memory_checksum({kKey.low + 1, kKey.high}, {1, 2}, message),
                                      memory_checksum({kKey.low, kKey.high + 1}, {1, 2}, message),
                                      memory_checksum(kKey, {2, 1}, message),
                                      memory_checksum(kKey, {1, 3}, message),
                                      memory_checksum(kKey, {1, 2}, longer),
                                      memory_checksum(kKey, {1, 2}, swapped)};
    EXPECT_EQ(all.size(), 7U);
}

}  // namespace
}  // namespace surefoot::gate_process
