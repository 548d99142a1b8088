// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/stamps.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr StampUnit kSeconds{"s", 9};
constexpr StampUnit kMilliseconds{"ms", 6};
constexpr StampUnit kMicroseconds{"us", 3};
constexpr StampUnit kNanoseconds{"ns", 0};

}  // namespace

std::optional<StampUnit> stamp_unit_named(std::string_view name) noexcept {
    if (name == "s" || name == "sec" || name == "seconds") return kSeconds;
    if (name == "ms") return kMilliseconds;
    if (name == "us" || name == "\xc2\xb5s") return kMicroseconds;
    if (name == "ns" || name == "nsec" || name == "nanoseconds") return kNanoseconds;
    return std::nullopt;
}

StampUnit stamp_unit_of(std::span<const std::string_view> words) {
    // These limits mean the year 1973 or later in each unit. 1e11 s would be the year 5138.
    constexpr double kSince1970_ns = 1e17;
    constexpr double kSince1970_us = 1e14;
    constexpr double kSince1970_ms = 1e11;
    constexpr double kStep_ns = 1e6;  // 1000 Hz
    std::vector<double> stamps;
    bool whole = true;
    for (const std::string_view word : words) {
        const auto value = parse_double(word);
        if (!value || !std::isfinite(*value)) continue;
        whole = whole && *value == std::floor(*value);
        stamps.push_back(*value);
    }
    if (stamps.empty()) return kSeconds;
    std::sort(stamps.begin(), stamps.end());
    if (stamps.front() >= kSince1970_ns) return kNanoseconds;
    if (stamps.front() >= kSince1970_us) return kMicroseconds;
    if (stamps.front() >= kSince1970_ms) return kMilliseconds;
    if (!whole || stamps.size() < 2) return kSeconds;
    std::vector<double> steps;
    for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle >= kStep_ns ? kNanoseconds : kSeconds;
}

std::optional<std::int64_t> parse_stamp_ns(std::string_view word, const StampUnit& unit) noexcept {
    return parse_decimal(word, unit.decimals);
}

}  // namespace surefoot::io
