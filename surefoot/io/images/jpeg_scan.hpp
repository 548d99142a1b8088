// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace surefoot::io {

/// Finds the first marker after the entropy-coded data at `at` (skips stuffed zeros, fill bytes and
/// restart markers: ITU-T T.81, B.1.1). Returns the size of `bytes` if there is none.
[[nodiscard]] inline std::size_t end_of_scan(std::string_view bytes, std::size_t at) noexcept {
    for (; at + 1 < bytes.size(); ++at) {
        const auto next = static_cast<std::uint8_t>(bytes[at + 1]);
        const bool inside = next == 0x00 || next == 0xff || (next >= 0xd0 && next <= 0xd7);
        if (bytes[at] == '\xff' && !inside) return at;
    }
    return bytes.size();
}

}  // namespace surefoot::io
