// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/views.hpp"
#include "surefoot/sim/rendering/texture.hpp"

namespace surefoot::sim {

/// One tile of a pattern: mean 0, standard deviation kPatternSigma before clipping to [-1, 1];
/// repeats without a seam in both directions. `size` is a power of two, at least 256.
inline constexpr float kPatternSigma = 0.4F;
[[nodiscard]] Image<float> draw_pattern(Pattern pattern, int size, std::uint64_t seed);

}  // namespace surefoot::sim
