// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace surefoot::io {

/// Stamps of a recording lie between 1970 and 2261, so that sums and differences stay in range.
inline constexpr std::int64_t kMaxStamp_ns = 9'200'000'000'000'000'000;

/// Unit of stamps in files.
struct StampUnit {
    std::string_view name;  ///< "s", "ms", "us" or "ns"
    int decimals = 9;       ///< stamp * 10^decimals is the time in ns
};

/// Returns the unit with this name ("s", "sec", "ns", ...); no value for other names.
[[nodiscard]] std::optional<StampUnit> stamp_unit_named(std::string_view name) noexcept;

/// Guesses the unit of stamps from their text. Stamps since 1970 are recognised by size: ns from
/// 1e17, us from 1e14, ms from 1e11. Whole numbers with another origin are ns if their median step
/// is a million or more (a million seconds would be eleven days). All others are seconds. Words
/// that are not numbers are ignored.
[[nodiscard]] StampUnit stamp_unit_of(std::span<const std::string_view> words);

/// Parses a stamp to nanoseconds, exact for plain digits; no value for other text or overflow.
[[nodiscard]] std::optional<std::int64_t> parse_stamp_ns(std::string_view word,
                                                         const StampUnit& unit) noexcept;

}  // namespace surefoot::io
