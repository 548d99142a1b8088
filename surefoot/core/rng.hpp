// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot {

/// Seeded generator xoshiro256** (Blackman and Vigna 2018); splitmix64 fills its state. The numbers
/// are the same on every platform, except those of normal(), which uses the log of libm.
class Rng {
  public:
    explicit Rng(std::uint64_t seed) noexcept;

    [[nodiscard]] std::uint64_t next_u64() noexcept;
    /// Returns a uniform number in [0, 1) with 53 random bits.
    [[nodiscard]] double uniform() noexcept;
    [[nodiscard]] double uniform(double low, double high) noexcept;
    /// Returns a uniform integer in [0, n), n > 0, without modulo bias.
    [[nodiscard]] std::uint64_t below(std::uint64_t n) noexcept;
    /// Returns a standard normal number (Marsaglia's polar method).
    [[nodiscard]] double normal() noexcept;

  private:
    std::uint64_t state_[4];
    double spare_normal_ = 0.0;
    bool has_spare_normal_ = false;
};

/// Combines a seed with a stream number: parallel parts then draw independent numbers.
[[nodiscard]] std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t stream) noexcept;

}  // namespace surefoot
