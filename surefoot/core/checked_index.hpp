// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <limits>
#include <optional>
#include <type_traits>

namespace surefoot {

/// True if `Int` can hold the integer part of the value: not NaN, not infinite, and in range.
/// Converting any other value is undefined behaviour. An x86 processor, for example, then silently
/// returns the smallest integer.
template <std::integral Int, std::floating_point Real>
[[nodiscard]] constexpr bool fits_integer(Real value) noexcept {
    // The limit is 2^digits. A Real holds it exactly; it cannot always hold the largest Int.
    constexpr Real kEnd = static_cast<Real>(std::numeric_limits<Int>::max() / 2 + 1) * Real{2};
    constexpr Real kLow = std::is_signed_v<Int> ? -kEnd : Real{0};
    return value < kEnd && (value >= kLow || value > kLow - Real{1});
}

/// Returns the integer part (rounded towards zero), or nullopt if `Int` cannot hold it.
template <std::integral Int, std::floating_point Real>
[[nodiscard]] constexpr std::optional<Int> checked_integer(Real value) noexcept {
    if (!fits_integer<Int>(value)) return std::nullopt;
    return static_cast<Int>(value);  // in range, as checked
}

/// Returns the integer part, limited to the range of `Int`, or `of_nan` if the value is NaN.
template <std::integral Int, std::floating_point Real>
[[nodiscard]] constexpr Int saturated_integer(Real value, Int of_nan = 0) noexcept {
    if (fits_integer<Int>(value)) return static_cast<Int>(value);  // in range, as checked
    if (value != value) return of_nan;
    return value > Real{0} ? std::numeric_limits<Int>::max() : std::numeric_limits<Int>::lowest();
}

/// Returns the integer part of a number, limited to [least, most]. NaN counts as 0.
template <std::integral Int, std::floating_point Real>
[[nodiscard]] constexpr Int clamped_integer(Real value, Int least, Int most) noexcept {
    return std::clamp(saturated_integer<Int>(value), least, most);
}

}  // namespace surefoot
