// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/rng.hpp"

#include <bit>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot {
namespace {

std::uint64_t splitmix64(std::uint64_t& x) noexcept {
    x += 0x9e3779b97f4a7c15U;
    std::uint64_t z = x;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

}  // namespace

Rng::Rng(std::uint64_t seed) noexcept : state_{} {
    for (auto& word : state_) word = splitmix64(seed);
}

std::uint64_t Rng::next_u64() noexcept {
    const std::uint64_t result = std::rotl(state_[1] * 5U, 7) * 9U;
    const std::uint64_t t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return result;
}

double Rng::uniform() noexcept {
    return static_cast<double>(next_u64() >> 11U) * 0x1.0p-53;
}

double Rng::uniform(double low, double high) noexcept {
    return low + (high - low) * uniform();
}

std::uint64_t Rng::below(std::uint64_t n) noexcept {
    SUREFOOT_ASSERT(n > 0);
    const std::uint64_t limit = ~std::uint64_t{0} - (~std::uint64_t{0} % n + 1U) % n;
    std::uint64_t draw = next_u64();
    while (draw > limit) draw = next_u64();
    return draw % n;
}

double Rng::normal() noexcept {
    if (has_spare_normal_) {
        has_spare_normal_ = false;
        return spare_normal_;
    }
    double a = 0.0;
    double b = 0.0;
    double s = 0.0;
    do {
        a = uniform(-1.0, 1.0);
        b = uniform(-1.0, 1.0);
        s = a * a + b * b;
    } while (s >= 1.0 || s == 0.0);
    const double scale = std::sqrt(-2.0 * std::log(s) / s);
    spare_normal_ = b * scale;
    has_spare_normal_ = true;
    return a * scale;
}

std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t stream) noexcept {
    std::uint64_t x = seed ^ (stream * 0xd1342543de82ef95U);
    return splitmix64(x);
}

}  // namespace surefoot
