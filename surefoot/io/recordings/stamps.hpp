// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace surefoot::io {

/// Stamps of a recording lie between 1970 and 2261, so that sums and differences stay in range.
inline constexpr std::int64_t kMaxStamp_ns = 9'200'000'000'000'000'000;

/// A unit that files give stamps in.
struct StampUnit {
    std::string_view name;  ///< "s", "ms", "us" or "ns"
    int decimals = 9;       ///< its stamps times 10^decimals are nanoseconds
};

/// The unit named so ("s", "sec", "ns", ...), or nothing.
[[nodiscard]] std::optional<StampUnit> stamp_unit_named(std::string_view name) noexcept;

/// The unit of stamps, as words of a file. Stamps since 1970 are told by their size: from 1e17 on
/// they are ns, from 1e14 on us, from 1e11 on ms. Whole numbers from another origin are ns where
/// they are a million or more apart (in s that would be eleven days). All else is seconds. Words
/// that are no numbers are passed over.
[[nodiscard]] StampUnit stamp_unit_of(std::span<const std::string_view> words);

/// A stamp in nanoseconds, exact for plain digits; nothing for anything that is no such number.
[[nodiscard]] std::optional<std::int64_t> parse_stamp_ns(std::string_view word,
                                                         const StampUnit& unit) noexcept;

}  // namespace surefoot::io
