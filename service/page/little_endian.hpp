// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <string>
#include <type_traits>

namespace surefoot::page {

// Numbers leave as they lie in memory.
static_assert(std::endian::native == std::endian::little);

/// Appends numbers to a message, without gaps.
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
