// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace surefoot::fuzz {

/// Reads decisions from the bytes of a fuzz input. Returns zeros after the last byte. `data` must
/// outlive this object.
class Choices {
  public:
    Choices(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    [[nodiscard]] bool done() const noexcept { return size_ == 0; }
    std::uint8_t byte() noexcept {
        if (size_ == 0) return 0;
        --size_;
        return *data_++;
    }
    /// A number from 0 to count - 1; 1 <= `count` <= 256.
    int below(int count) noexcept { return byte() % count; }
    bool yes() noexcept { return (byte() & 1U) != 0U; }
    /// A number within +-32 times `unit`. For one first byte in 16 it is a special value instead:
    /// NaN, infinity, a signed zero, a denormal, or a very small or very large number.
    float number(float unit) noexcept {
        const std::uint8_t kind = byte();
        if (kind % 16 == 15) return kNasty[static_cast<std::size_t>(below(kNasties))];
        const int value = (byte() << 8U | kind) - 32768;
        return static_cast<float>(value) / 1024.0F * unit;
    }

  private:
    static constexpr float kInf = std::numeric_limits<float>::infinity();
    static constexpr int kNasties = 14;
    static constexpr std::array<float, kNasties> kNasty{std::numeric_limits<float>::quiet_NaN(),
                                                        kInf,
                                                        -kInf,
                                                        0.0F,
                                                        -0.0F,
                                                        1e-30F,
                                                        -1e-30F,
                                                        1e-44F,
                                                        1e10F,
                                                        -1e10F,
                                                        1e30F,
                                                        -1e30F,
                                                        3.4e38F,
                                                        -3.4e38F};
    const std::uint8_t* data_;
    std::size_t size_;
};

}  // namespace surefoot::fuzz
