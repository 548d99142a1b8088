// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {

/// Uniform number in [0, 1), a function of (seed, stream, index) alone: it does not depend on the
/// order of evaluation. PixelNoise does the same for Gaussian numbers.
[[nodiscard]] inline double uniform_at(std::uint64_t seed,
                                       std::uint64_t stream,
                                       std::uint64_t index) noexcept {
    constexpr double kUnit = 0x1p-53;
    return static_cast<double>(mix_seed(mix_seed(seed, stream), index) >> 11U) * kUnit;
}

}  // namespace surefoot::sim
