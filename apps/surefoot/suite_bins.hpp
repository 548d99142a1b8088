// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/report/error_histogram.hpp"

namespace surefoot::app {

/// By what the errors of a map are sorted.
enum class BinKey : std::uint8_t {
    range,        ///< |height error| by the distance from the camera that saw the cell last [m]
    column,       ///< |height error| by the image column where it was seen last [px]
    jump_column,  ///< |jump between neighbours| on level floor, by image column [px]
};
inline constexpr const char* kBinKeyNames[] = {"range", "column", "jump_column"};
[[nodiscard]] constexpr const char* unit_of(BinKey key) noexcept {
    return key == BinKey::range ? "m" : "px";
}

/// The errors of one case whose key is in [from, to).
struct SuiteBin {
    BinKey key = BinKey::range;
    double from = 0.0;
    double to = 0.0;
    eval::ErrorHistogram errors;

    friend bool operator==(const SuiteBin&, const SuiteBin&) = default;
};

/// Every bin of a comparison in which there is an error.
[[nodiscard]] std::vector<SuiteBin> bins_of(const eval::MapComparison& maps);

/// Adds errors up over bins of the same key and ends; in the order of key and ends.
[[nodiscard]] std::vector<SuiteBin> pooled(std::span<const SuiteBin> bins);

/// Counts as they are written to a file: "12:3 15:1" is 3 errors in bin 12 and 1 in bin 15.
[[nodiscard]] std::string format_counts(const eval::ErrorHistogram& errors);
/// Nothing for a text that is not whole.
[[nodiscard]] std::optional<eval::ErrorHistogram> parse_counts(std::string_view text);

}  // namespace surefoot::app
