// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <string>
#include <type_traits>

namespace surefoot::page {

// Messages are little-endian; MessageWriter copies numbers as they are in memory.
static_assert(std::endian::native == std::endian::little);

/// Appends numbers to a binary message, without padding.
class MessageWriter {
  public:
    explicit MessageWriter(std::string& out) : out_(out) {}
    template <typename T>
    MessageWriter& operator<<(T value) {
        static_assert(std::is_arithmetic_v<T>);
        out_.append(reinterpret_cast<const char*>(&value), sizeof(value));
        return *this;
    }

  private:
    std::string& out_;
};

}  // namespace surefoot::page
