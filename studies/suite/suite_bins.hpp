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

/// Quantity by which map errors are binned.
enum class BinKey : std::uint8_t {
    range,   ///< |height error| by distance [m] between camera and cell at its last observation
    column,  ///< |height error| by image column [px] of the cell at its last observation
    jump_column,  ///< |height step between neighbouring cells| of level floor, by image column [px]
};
inline constexpr const char* kBinKeyNames[] = {"range", "column", "jump_column"};
[[nodiscard]] constexpr const char* unit_of(BinKey key) noexcept {
    return key == BinKey::range ? "m" : "px";
}

/// Errors of one case whose binned quantity is in [from, to).
struct SuiteBin {
    BinKey key = BinKey::range;
    double from = 0.0;
    double to = 0.0;
    eval::ErrorHistogram errors;

    friend bool operator==(const SuiteBin&, const SuiteBin&) = default;
};

/// All bins of a comparison that contain at least one error.
[[nodiscard]] std::vector<SuiteBin> bins_of(const eval::MapComparison& maps);

/// Sums the errors of bins with the same key and limits. The result is sorted by key and limits.
[[nodiscard]] std::vector<SuiteBin> pooled(std::span<const SuiteBin> bins);

/// Returns the counts as text for a file: "12:3 15:1" = 3 errors in bin 12 and 1 in bin 15.
[[nodiscard]] std::string format_counts(const eval::ErrorHistogram& errors);
/// Reads the text of format_counts(); empty if the text is incomplete.
[[nodiscard]] std::optional<eval::ErrorHistogram> parse_counts(std::string_view text);

}  // namespace surefoot::app
