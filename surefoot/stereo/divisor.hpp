// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace surefoot::stereo {

/// Divides by one whole number below 2^10 whose odd part is below 2^8, with multiplications alone,
/// and rounds as a division does: dividing takes a processor ten times as long, and no other
/// program may see a difference.
///
/// The inverse and x are taken apart, x = h + l and 1 / n = H + L with 12 bits in h and H, so that
/// h H is exact. What is added to it, h L + l / n, is smaller by 2^-11 and thus off by less than
/// 2^-34 of the quotient. A quotient by an odd part m is never nearer than 2^-25 / m to the middle
/// between two floats, where rounding turns: 2^-33. For x = 0 and 2^-80 <= |x| <= 2^80.
class Divisor {
  public:
    constexpr explicit Divisor(int divisor)
        : inverse_(static_cast<float>(1.0 / divisor)),
          upper_(upper_half(inverse_)),
          lower_(static_cast<float>(1.0 / divisor - static_cast<double>(upper_))) {}

    [[nodiscard]] constexpr float divide(float x) const noexcept {
        const float high = upper_half(x);
        return high * upper_ + (high * lower_ + (x - high) * inverse_);
    }

    // For those who divide many numbers side by side.
    static constexpr std::uint32_t kUpperHalf = 0xfffff000U;  ///< bits of a float
    [[nodiscard]] constexpr float inverse() const noexcept { return inverse_; }
    [[nodiscard]] constexpr float upper() const noexcept { return upper_; }
    [[nodiscard]] constexpr float lower() const noexcept { return lower_; }

  private:
    static constexpr float upper_half(float x) noexcept {
        return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & kUpperHalf);
    }
    float inverse_;
    float upper_;
    float lower_;
};

}  // namespace surefoot::stereo
