// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "surefoot/gate/reason.hpp"

/// Encoding of the audit log's fields: little-endian, consecutive, without padding.
namespace surefoot::gate_process {

// Map layers are copied row by row, in the byte order of the memory.
static_assert(std::endian::native == std::endian::little);

/// Returns the number stored for a field: the value of an enum, the bits of a set of reasons.
template <typename T>
[[nodiscard]] auto stored(const T& value) noexcept {
    if constexpr (std::is_same_v<T, bool>) {
        return static_cast<std::uint8_t>(value);
    } else if constexpr (std::is_enum_v<T>) {
        return static_cast<std::underlying_type_t<T>>(value);
    } else if constexpr (std::is_same_v<T, gate::ReasonSet> ||
                         std::is_same_v<T, std::array<char, 8>>) {
        return std::bit_cast<std::uint64_t>(value);
    } else {
        static_assert(std::is_arithmetic_v<T>);
        return value;
    }
}

/// Visits fields (name, value) and counts their bytes.
class ByteCounter {
  public:
    template <typename T>
    void operator()(const char*, const T& value) noexcept {
        bytes_ += sizeof(stored(value));
    }
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

  private:
    std::size_t bytes_ = 0;
};

/// Writes fields into a buffer that is large enough.
class ByteWriter {
  public:
    explicit ByteWriter(char* at) noexcept : at_(at) {}
    template <typename T>
    void operator()(const char*, const T& value) noexcept {
        const auto number = stored(value);
        copy(&number, sizeof(number));
    }
    void copy(const void* from, std::size_t bytes) noexcept {
        std::memcpy(at_, from, bytes);
        at_ += bytes;
    }

  private:
    char* at_;
};

/// Reads the bytes of ByteWriter. `ok` is false after too few bytes or a bool that is not 0 or 1.
class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) noexcept : rest_(bytes) {}
    template <typename T>
    void operator()(const char*, T& value) noexcept {
        decltype(stored(value)) number{};
        copy(&number, sizeof(number));
        if constexpr (std::is_same_v<T, bool>) {
            ok_ = ok_ && number <= 1;
            value = number == 1;
        } else if constexpr (std::is_enum_v<T>) {
            value = static_cast<T>(number);
        } else {
            value = std::bit_cast<T>(number);
        }
    }
    void copy(void* to, std::size_t bytes) noexcept {
        ok_ = ok_ && rest_.size() >= bytes;
        if (!ok_) return;
        std::memcpy(to, rest_.data(), bytes);
        rest_.remove_prefix(bytes);
    }
    [[nodiscard]] bool ok() const noexcept { return ok_; }
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

  private:
    std::string_view rest_;
    bool ok_ = true;
};

}  // namespace surefoot::gate_process
