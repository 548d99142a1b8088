// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/keyed_checksum.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

namespace surefoot::gate_process {
namespace {

/// The key 00 01 .. 0f of the published vectors.
ChecksumKey published_key() {
    return {0x0706050403020100ULL, 0x0f0e0d0c0b0a0908ULL};
}

std::uint64_t checksum_of(std::span<const unsigned char> message) {
    KeyedChecksum checksum(published_key());
    checksum.add(message);
    return checksum.finish();
}

// Messages 00 01 02 .. of 0, 1, 2 .. bytes: appendix A of the paper has the one of 15 bytes, the
// authors' reference implementation (vectors.h) has all of them.
TEST(KeyedChecksum, gives_the_published_vectors) {
    constexpr std::array<std::uint64_t, 16> kExpected{0x726fdb47dd0e0e31ULL,
                                                      0x74f839c593dc67fdULL,
                                                      0x0d6c8009d9a94f5aULL,
                                                      0x85676696d7fb7e2dULL,
                                                      0xcf2794e0277187b7ULL,
                                                      0x18765564cd99a68dULL,
                                                      0xcbc9466e58fee3ceULL,
                                                      0xab0200f58b01d137ULL,
                                                      0x93f5f5799a932462ULL,
                                                      0x9e0082df0ba9e4b0ULL,
                                                      0x7a5dbbc594ddb9f3ULL,
                                                      0xf4b32f46226bada7ULL,
                                                      0x751e8fbc860ee5fbULL,
                                                      0x14ea5627c0843d90ULL,
                                                      0xf723ca908e7af2eeULL,
                                                      0xa129ca6149be45e5ULL};
    std::array<unsigned char, 15> message{};
    for (std::size_t i = 0; i < message.size(); ++i) message[i] = static_cast<unsigned char>(i);
    for (std::size_t length = 0; length < kExpected.size(); ++length)
        EXPECT_EQ(checksum_of(std::span(message).first(length)), kExpected[length]) << length;
}

TEST(KeyedChecksum, words_count_as_their_bytes) {
    std::array<unsigned char, 19> message{};
    for (std::size_t i = 0; i < message.size(); ++i) message[i] = static_cast<unsigned char>(9 * i);
    KeyedChecksum checksum(published_key());
    checksum.add(0x3f362d241b120900ULL);
    checksum.add(std::span<const unsigned char>(message).subspan(8));
    EXPECT_EQ(checksum.finish(), checksum_of(message));
}

TEST(KeyedChecksum, another_key_gives_another_checksum) {
    const std::array<unsigned char, 8> message{};
    for (const ChecksumKey key : {ChecksumKey{published_key().low ^ 1U, published_key().high},
                                  ChecksumKey{published_key().low, published_key().high ^ 1U}}) {
        KeyedChecksum checksum(key);
        checksum.add(message);
        EXPECT_NE(checksum.finish(), checksum_of(message));
    }
}

TEST(ChecksumKeys, new_keys_differ_and_travel_as_bytes) {
    const auto one = new_checksum_key();
    const auto other = new_checksum_key();
    ASSERT_TRUE(one.ok() && other.ok());
    EXPECT_NE(*one, *other);
    EXPECT_EQ(key_of(bytes_of(*one)), *one);
    EXPECT_EQ(bytes_of(published_key())[15], '\x0f');
}

class KeyFile : public ::testing::Test {
  protected:
    KeyFile()
        : path_((std::filesystem::temp_directory_path() /
                 ("surefoot_key_" + std::to_string(::getpid())))
                    .string()) {}
    ~KeyFile() override { std::filesystem::remove(path_); }

    Result<ChecksumKey> read(const std::string& text, mode_t rights = 0600) {
        { std::ofstream(path_) << text; }
        EXPECT_EQ(::chmod(path_.c_str(), rights), 0);
        return read_checksum_key(path_);
    }

    std::string path_;
};

TEST_F(KeyFile, has_32_digits) {
    const auto key = read("0f0e0d0c0b0a09080706050403020100\n");
    ASSERT_TRUE(key.ok()) << key.error().message;
    EXPECT_EQ(*key, published_key());
    for (const char* wrong : {"",
                              "0f0e0d0c0b0a0908070605040302010",
                              "0f0e0d0c0b0a090807060504030201000",
                              "0f0e0d0c0b0a0908070605040302010g",
                              "0x0e0d0c0b0a09080706050403020100"}) {
        const auto refused = read(wrong);
        ASSERT_FALSE(refused.ok()) << wrong;
        EXPECT_NE(refused.error().message.find("32 hexadecimal digits"), std::string::npos);
    }
}

TEST_F(KeyFile, that_others_can_read_is_refused) {
    const auto refused = read("0f0e0d0c0b0a09080706050403020100", 0640);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("chmod 600"), std::string::npos);
}

TEST_F(KeyFile, that_is_missing_or_no_file_is_refused_at_once) {
    EXPECT_FALSE(read_checksum_key(path_).ok());
    ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
    EXPECT_FALSE(read_checksum_key(path_).ok()) << "nobody writes into this pipe";
}

}  // namespace
}  // namespace surefoot::gate_process
