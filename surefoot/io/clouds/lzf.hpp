// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace surefoot::io {

/// Unpacks LZF data (the compression inside PCD files) of a known size. The format: a control byte
/// below 32 starts a run of control + 1 literal bytes; otherwise its upper three bits are a length
/// (7: one more byte adds to it), the lower five and the next byte an offset backwards, and
/// length + 2 bytes are copied from offset + 1 bytes before. Nothing where the data are damaged or
/// do not make exactly `size` bytes.
[[nodiscard]] std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size);

/// Largest size that `packed_size` bytes can unpack to: 3 bytes copy at most 264.
[[nodiscard]] constexpr std::size_t lzf_limit(std::size_t packed_size) noexcept {
    return packed_size * 88;
}

/// Packs into a valid LZF stream that unpack_lzf and others read; greedy, one candidate per hash.
[[nodiscard]] std::string pack_lzf(std::string_view data);

}  // namespace surefoot::io
