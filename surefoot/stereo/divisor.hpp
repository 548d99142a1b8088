// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace surefoot::stereo {

/// Divides floats by one whole number below 2^10 with an odd part below 2^8. Uses multiplications,
/// because a division takes a processor ten times as long as a multiplication. The result is
/// rounded exactly like the result of a division.
///
/// The proof splits x = h + l and 1 / n = H + L, with 12 bits in h and in H, so that h H is exact.
/// The rest, h L + l / n, is smaller by a factor of 2^-11, so its error is below 2^-34 of the
/// quotient. A quotient by an odd part m is at least 2^-25 / m = 2^-33 away from the middle between
/// two floats, where rounding changes direction. Valid for x = 0 and 2^-80 <= |x| <= 2^80.
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

    // These members are for callers that divide many numbers side by side in a register.
    static constexpr std::uint32_t kUpperHalf = 0xfffff000U;  ///< sign, exponent, 11 fraction bits
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
