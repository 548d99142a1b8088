// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_bins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

void add_bins(std::vector<SuiteBin>& bins, BinKey key, std::span<const eval::ErrorBin> found) {
    for (const eval::ErrorBin& bin : found) {
        if (bin.histogram.count() > 0) bins.push_back({key, bin.from, bin.to, bin.histogram});
    }
}

}  // namespace

std::vector<SuiteBin> bins_of(const eval::MapComparison& maps) {
    std::vector<SuiteBin> bins;
    add_bins(bins, BinKey::range, maps.by_range);
    add_bins(bins, BinKey::column, maps.by_column);
    add_bins(bins, BinKey::jump_column, maps.edges_by_column);
    return bins;
}

std::vector<SuiteBin> pooled(std::span<const SuiteBin> bins) {
    const auto place_of = [](const SuiteBin& bin) { return std::tie(bin.key, bin.from, bin.to); };
    std::vector<SuiteBin> sums;
    for (const SuiteBin& bin : bins) {
        const auto at = std::lower_bound(
            sums.begin(), sums.end(), bin, [&](const SuiteBin& a, const SuiteBin& b) {
                return place_of(a) < place_of(b);
            });
        if (at != sums.end() && place_of(*at) == place_of(bin)) {
            at->errors += bin.errors;
        } else {
            sums.insert(at, bin);
        }
    }
    return sums;
}

std::string format_counts(const eval::ErrorHistogram& errors) {
    std::string text;
    for (int bin = 0; bin < eval::ErrorHistogram::kBins; ++bin) {
        if (errors.count_in(bin) == 0) continue;
        text += fmt::format("{}{}:{}", text.empty() ? "" : " ", bin, errors.count_in(bin));
    }
    return text;
}

std::optional<eval::ErrorHistogram> parse_counts(std::string_view text) {
    eval::ErrorHistogram errors;
    for (const std::string_view word : io::split(text, " ")) {
        const std::size_t colon = word.find(':');
        if (colon == std::string_view::npos) return std::nullopt;
        const auto bin = io::parse_int64(word.substr(0, colon));
        const auto count = io::parse_int64(word.substr(colon + 1));
        const bool whole =
            bin && count && *bin >= 0 && *bin<eval::ErrorHistogram::kBins&& * count> 0;
        if (!whole) return std::nullopt;
        errors.add_count(static_cast<int>(*bin), *count);
    }
    return errors;
}

}  // namespace surefoot::app
