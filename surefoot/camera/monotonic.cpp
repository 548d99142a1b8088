// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/monotonic.hpp"

#include <array>
#include <cstddef>

#include "surefoot/core/assert.hpp"

namespace surefoot::camera {
namespace {

constexpr std::size_t kMaxTerms = 8;
constexpr int kMaxHalvings = 40;
using Bernstein = std::array<double, kMaxTerms>;

/// b[j] = sum_{i<=j} C(j,i)/C(n,i) c[i] s_max^i
Bernstein bernstein_of(std::span<const double> coefficients, double s_max) noexcept {
    const std::size_t terms = coefficients.size();
    Bernstein scaled{};
    double power = 1.0;
    double n_choose_i = 1.0;
    for (std::size_t i = 0; i < terms; ++i) {
        scaled[i] = coefficients[i] * power / n_choose_i;
        power *= s_max;
        n_choose_i *= static_cast<double>(terms - 1 - i) / static_cast<double>(i + 1);
    }
    Bernstein b{};
    for (std::size_t j = 0; j < terms; ++j) {
        double j_choose_i = 1.0;
        for (std::size_t i = 0; i <= j; ++i) {
            b[j] += j_choose_i * scaled[i];
            j_choose_i *= static_cast<double>(j - i) / static_cast<double>(i + 1);
        }
    }
    return b;
}

bool positive(Bernstein b, std::size_t terms, int halvings_left) noexcept {
    // The outer coefficients are the values at the ends. The comparison with ! also rejects NaN.
    if (!(b[0] > 0.0) || !(b[terms - 1] > 0.0)) return false;
    bool all_positive = true;
    for (std::size_t i = 1; i + 1 < terms; ++i) all_positive = all_positive && b[i] > 0.0;
    if (all_positive) return true;
    if (halvings_left == 0) return false;
    // De Casteljau's algorithm at the middle: b becomes the right half, `left_half` receives the
    // left half.
    Bernstein left_half{};
    for (std::size_t level = 0; level < terms; ++level) {
        left_half[level] = b[0];
        for (std::size_t i = 0; i + 1 < terms - level; ++i) b[i] = 0.5 * (b[i] + b[i + 1]);
    }
    Bernstein right_half{};
    for (std::size_t i = 0; i < terms; ++i) right_half[i] = b[i];
    return positive(left_half, terms, halvings_left - 1) &&
           positive(right_half, terms, halvings_left - 1);
}

}  // namespace

bool positive_on(std::span<const double> coefficients, double s_max) noexcept {
    SUREFOOT_ASSERT(!coefficients.empty() && coefficients.size() <= kMaxTerms);
    return positive(bernstein_of(coefficients, s_max), coefficients.size(), kMaxHalvings);
}

}  // namespace surefoot::camera
