// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace surefoot {

inline constexpr std::uint64_t kFnv1aStart = 0xcbf29ce484222325ULL;

/// Returns the 64-bit FNV-1a hash (Fowler, Noll, Vo): the same on every platform. It detects damage
/// and distinguishes texts, but does not stop an attacker. `before`: hash of the preceding bytes.
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view bytes,
                                            std::uint64_t before = kFnv1aStart) noexcept {
    std::uint64_t hash = before;
    for (const char byte : bytes)
        hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
    return hash;
}

}  // namespace surefoot
