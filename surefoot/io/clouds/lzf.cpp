// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/lzf.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxLiterals = 32;
constexpr std::size_t kMaxOffset = 1 << 13;
constexpr std::size_t kMaxLength = 264;

std::uint8_t byte_at(std::string_view text, std::size_t at) noexcept {
    return static_cast<std::uint8_t>(text[at]);
}

void append_literals(std::string& out, std::string_view literals) {
    while (!literals.empty()) {
        const std::size_t count = std::min(literals.size(), kMaxLiterals);
        out += static_cast<char>(count - 1);
        out += literals.substr(0, count);
        literals.remove_prefix(count);
    }
}

void append_copy(std::string& out, std::size_t offset, std::size_t length) {
    const std::size_t code = length - 2;
    const std::size_t back = offset - 1;
    out += static_cast<char>((std::min<std::size_t>(code, 7) << 5) | (back >> 8));
    if (code >= 7) out += static_cast<char>(code - 7);
    out += static_cast<char>(back & 0xff);
}

}  // namespace

std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size) {
    if (size > lzf_limit(packed.size())) return std::nullopt;
    std::string out;
    out.reserve(size);
    std::size_t at = 0;
    while (at < packed.size()) {
        const std::size_t control = byte_at(packed, at++);
        if (control < kMaxLiterals) {
            const std::size_t count = control + 1;
            if (packed.size() - at < count || size - out.size() < count) return std::nullopt;
            out += packed.substr(at, count);
            at += count;
            continue;
        }
        std::size_t length = control >> 5;
        const std::size_t extra_bytes = length == 7 ? 2 : 1;
        if (packed.size() - at < extra_bytes) return std::nullopt;
        if (length == 7) length += byte_at(packed, at++);
        const std::size_t offset = ((control & 0x1f) << 8) + byte_at(packed, at++) + 1;
        length += 2;
        if (offset > out.size() || size - out.size() < length) return std::nullopt;
        // Copy byte by byte: source and target may overlap, because LZF packs runs in this way.
        for (std::size_t i = 0; i < length; ++i) out += out[out.size() - offset];
    }
    if (out.size() != size) return std::nullopt;
    return out;
}

std::string pack_lzf(std::string_view data) {
    constexpr std::size_t kHashBits = 14;
    std::vector<std::size_t> last(std::size_t{1} << kHashBits, data.size());
    std::string out;
    std::size_t literals_from = 0;
    std::size_t at = 0;
    while (data.size() - at >= 3) {
        const std::uint32_t triple = static_cast<std::uint32_t>(byte_at(data, at)) << 16 |
                                     static_cast<std::uint32_t>(byte_at(data, at + 1)) << 8 |
                                     byte_at(data, at + 2);
        // Computes a multiplicative hash: the upper bits of the product depend on all three bytes.
        std::size_t& slot = last[(triple * 2654435761U) >> (32 - kHashBits)];
        const std::size_t candidate = slot;
        slot = at;
        std::size_t length = 0;
        if (candidate < at && at - candidate <= kMaxOffset) {
            const std::size_t limit = std::min(data.size() - at, kMaxLength);
            while (length < limit && data[candidate + length] == data[at + length]) ++length;
        }
        if (length < 3) {
            ++at;
            continue;
        }
        append_literals(out, data.substr(literals_from, at - literals_from));
        append_copy(out, at - candidate, length);
        at += length;
        literals_from = at;
    }
    append_literals(out, data.substr(literals_from));
    return out;
}

}  // namespace surefoot::io
