// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/keyed_checksum.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>

namespace surefoot::gate_process {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the checksum reads words in the byte order of the memory and needs little-endian");
constexpr std::size_t kWord = sizeof(std::uint64_t);

std::uint64_t word_at(const void* bytes) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, kWord);
    return word;
}

/// One SipRound of the paper (section 2, figure 2.1).
void round(std::uint64_t& v0, std::uint64_t& v1, std::uint64_t& v2, std::uint64_t& v3) noexcept {
    v0 += v1;
    v2 += v3;
    v1 = std::rotl(v1, 13) ^ v0;
    v3 = std::rotl(v3, 16) ^ v2;
    v0 = std::rotl(v0, 32);
    v2 += v1;
    v0 += v3;
    v1 = std::rotl(v1, 17) ^ v2;
    v3 = std::rotl(v3, 21) ^ v0;
    v2 = std::rotl(v2, 32);
}

Error key_error(const std::string& path, const std::string& what) {
    return usage_error("key file " + path + ": " + what);
}

/// Reads at most 64 bytes. A key has 32 digits, so a longer file is not a key file.
Result<std::string> read_small_file(const std::string& path) {
    constexpr std::size_t kMost_bytes = 64;
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return key_error(path, "it cannot be opened; check its path and permissions");
    struct stat info {};
    const bool known = ::fstat(file, &info) == 0 && S_ISREG(info.st_mode);
    std::array<char, kMost_bytes> bytes{};
    const ssize_t got = known ? ::read(file, bytes.data(), bytes.size()) : -1;
    ::close(file);
    if (got < 0) return key_error(path, "it is not a regular file that can be read");
    if ((info.st_mode & 077U) != 0)
        return key_error(path, "other users may read or change it; run: chmod 600 " + path);
    return std::string(bytes.data(), static_cast<std::size_t>(got));
}

}  // namespace

Result<ChecksumKey> new_checksum_key() {
    std::array<char, 2 * kWord> bytes{};
    std::size_t have = 0;
    while (have < bytes.size()) {
        const ssize_t got = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
        if (got < 0 && errno != EINTR)
            return input_error("the operating system gives no random numbers: getrandom failed");
        if (got > 0) have += static_cast<std::size_t>(got);
    }
    return key_of({bytes.data(), bytes.size()});
}

Result<ChecksumKey> read_checksum_key(const std::string& path) {
    constexpr std::size_t kDigits = 32;
    auto text = read_small_file(path);
    if (!text) return text.error();
    const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
    while (!text->empty() && is_space(text->back())) text->pop_back();
    const char* const begin = text->data();
    const char* const middle = begin + kDigits / 2;
    ChecksumKey key;
    const bool valid = text->size() == kDigits &&
                       std::from_chars(begin, middle, key.high, 16).ptr == middle &&
                       std::from_chars(middle, begin + kDigits, key.low, 16).ptr == begin + kDigits;
    if (!valid)
        return key_error(path,
                         "32 hexadecimal digits are needed; make a key with: (umask 077; od -An "
                         "-N16 -tx8 /dev/urandom | tr -d ' ' > " +
                             path + ")");
    return key;
}

std::string bytes_of(const ChecksumKey& key) {
    std::string bytes(2 * kWord, '\0');
    std::memcpy(bytes.data(), &key.low, kWord);
    std::memcpy(bytes.data() + kWord, &key.high, kWord);
    return bytes;
}

ChecksumKey key_of(std::string_view bytes) noexcept {
    return {word_at(bytes.data()), word_at(bytes.data() + kWord)};
}

// The constants spell "somepseudorandomlygeneratedbytes".
KeyedChecksum::KeyedChecksum(const ChecksumKey& key) noexcept
    : v0_(key.low ^ 0x736f6d6570736575ULL),
      v1_(key.high ^ 0x646f72616e646f6dULL),
      v2_(key.low ^ 0x6c7967656e657261ULL),
      v3_(key.high ^ 0x7465646279746573ULL) {}

void KeyedChecksum::compress(std::uint64_t word) noexcept {
    v3_ ^= word;
    round(v0_, v1_, v2_, v3_);
    round(v0_, v1_, v2_, v3_);
    v0_ ^= word;
}

void KeyedChecksum::add(std::uint64_t word) noexcept {
    length_ += kWord;
    compress(word);
}

void KeyedChecksum::add(std::span<const unsigned char> bytes) noexcept {
    KeyedChecksum state = *this;  // copies that stay in registers during the loop
    const std::size_t whole = bytes.size() / kWord * kWord;
    for (std::size_t i = 0; i < whole; i += kWord) state.compress(word_at(bytes.data() + i));
    if (whole < bytes.size()) std::memcpy(&state.tail_, bytes.data() + whole, bytes.size() - whole);
    state.length_ += bytes.size();
    *this = state;
}

std::uint64_t KeyedChecksum::finish() noexcept {
    constexpr std::uint64_t kEnd = 0xff;
    compress(tail_ | length_ << 56U);
    v2_ ^= kEnd;
    for (int i = 0; i < 4; ++i) round(v0_, v1_, v2_, v3_);
    return v0_ ^ v1_ ^ v2_ ^ v3_;
}

}  // namespace surefoot::gate_process
