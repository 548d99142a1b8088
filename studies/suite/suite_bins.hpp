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

/// Key by which map errors are binned.
enum class BinKey : std::uint8_t {
    range,   ///< |height error| by distance from the camera at the last observation of the cell [m]
    column,  ///< |height error| by image column at the last observation of the cell [px]
    jump_column,  ///< |height jump between neighbour cells| on level floor, by image column [px]
};
inline constexpr const char* kBinKeyNames[] = {"range", "column", "jump_column"};
[[nodiscard]] constexpr const char* unit_of(BinKey key) noexcept {
    return key == BinKey::range ? "m" : "px";
}

/// Errors of one case whose key value is in [from, to).
struct SuiteBin {
    BinKey key = BinKey::range;
    double from = 0.0;
    double to = 0.0;
    eval::ErrorHistogram errors;

    friend bool operator==(const SuiteBin&, const SuiteBin&) = default;
};

/// All bins of a comparison that contain an error.
[[nodiscard]] std::vector<SuiteBin> bins_of(const eval::MapComparison& maps);

/// Sums the errors of bins with the same key and limits; sorted by key and limits.
[[nodiscard]] std::vector<SuiteBin> pooled(std::span<const SuiteBin> bins);

/// Text of the counts for a file: "12:3 15:1" means 3 errors in bin 12 and 1 in bin 15.
[[nodiscard]] std::string format_counts(const eval::ErrorHistogram& errors);
/// Reads the text of format_counts(); empty if the text is incomplete.
[[nodiscard]] std::optional<eval::ErrorHistogram> parse_counts(std::string_view text);

}  // namespace surefoot::app
