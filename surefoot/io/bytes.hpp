// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

/// Reads and writes numbers of binary files in a fixed byte order, on any machine.
namespace surefoot::io {

template <typename T>
[[nodiscard]] T load(const char* bytes, std::endian order) noexcept {
    static_assert(std::is_arithmetic_v<T>);
    char copy[sizeof(T)];
    std::memcpy(copy, bytes, sizeof(T));
    if (order != std::endian::native) std::reverse(copy, copy + sizeof(T));
    T value;
    std::memcpy(&value, copy, sizeof(T));
    return value;
}

template <typename T>
[[nodiscard]] T load_le(const char* bytes) noexcept {
    return load<T>(bytes, std::endian::little);
}

template <typename T>
void store(std::string& out, T value, std::endian order) {
    static_assert(std::is_arithmetic_v<T>);
    char copy[sizeof(T)];
    std::memcpy(copy, &value, sizeof(T));
    if (order != std::endian::native) std::reverse(copy, copy + sizeof(T));
    out.append(copy, sizeof(T));
}

template <typename T>
void store_le(std::string& out, T value) {
    store(out, value, std::endian::little);
}

}  // namespace surefoot::io
