// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace surefoot::io {

/// Unpacks LZF data (the compression inside PCD files) of a known size. Format: a control byte
/// below 32 starts a run of control + 1 literal bytes. Otherwise its upper three bits are a length
/// (if 7, add the next byte). The lower five bits and the next byte are an offset. Then length + 2
/// bytes are copied from offset + 1 bytes before the end of the output. No value if the data are
/// damaged or do not give exactly `size` bytes.
[[nodiscard]] std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size);

/// Returns the largest unpacked size of `packed_size` bytes: 3 bytes copy at most 264 bytes.
[[nodiscard]] constexpr std::size_t lzf_limit(std::size_t packed_size) noexcept {
    return packed_size * 88;
}

/// Packs into a valid LZF stream for unpack_lzf and other programs; greedy, one candidate per hash.
[[nodiscard]] std::string pack_lzf(std::string_view data);

}  // namespace surefoot::io
