// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/pairing.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "surefoot/io/recordings/stamps.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

struct Match {
    std::int64_t distance_ns;
    std::size_t left;
    std::size_t right;
};

/// Returns the pairs within the tolerance, at most 16 for each left image, the closest pair first.
std::vector<Match> candidates(const std::vector<std::int64_t>& left_ns,
                              const std::vector<std::int64_t>& right_ns,
                              std::int64_t tolerance_ns) {
    std::vector<std::size_t> order(right_ns.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return right_ns[a] < right_ns[b];
    });
    std::vector<Match> matches;
    for (std::size_t l = 0; l < left_ns.size(); ++l) {
        const std::int64_t time_ns = left_ns[l];
        auto r = std::lower_bound(
            order.begin(),
            order.end(),
            time_ns - tolerance_ns,
            [&](std::size_t i, std::int64_t earliest_ns) { return right_ns[i] < earliest_ns; });
        // Normally few frames lie within the tolerance. The limit bounds the work for damaged
        // lists.
        for (int n = 0; n < 16 && r != order.end() && right_ns[*r] <= time_ns + tolerance_ns; ++n) {
            matches.push_back({std::abs(right_ns[*r] - time_ns), l, *r});
            ++r;
        }
    }
    std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
        return a.distance_ns < b.distance_ns;
    });
    return matches;
}

/// Returns the nanoseconds per unit of a stamp since 1970 with this number of digits. 0 = no stamp
/// has this number of digits.
std::int64_t tick_ns(std::size_t digits) {
    switch (digits) {
        case 13: return 1'000'000;
        case 16: return 1'000;
        case 19: return 1;
        default: return 0;
    }
}

}  // namespace

Partners pair_by_time(const std::vector<std::int64_t>& left_ns,
                      const std::vector<std::int64_t>& right_ns,
                      std::int64_t tolerance_ns) {
    Partners partners(left_ns.size());
    std::vector<bool> used(right_ns.size(), false);
    for (const Match& match : candidates(left_ns, right_ns, tolerance_ns)) {
        if (partners[match.left] || used[match.right]) continue;
        partners[match.left] = match.right;
        used[match.right] = true;
    }
    return partners;
}

std::int64_t fifth_of_frame_time_ns(std::vector<std::int64_t> times_ns) {
    if (times_ns.size() < 2) return 0;
    for (std::size_t i = times_ns.size() - 1; i > 0; --i)
        times_ns[i] = std::abs(times_ns[i] - times_ns[i - 1]);
    const auto middle = times_ns.begin() + 1 + static_cast<std::ptrdiff_t>(times_ns.size() - 1) / 2;
    std::nth_element(times_ns.begin() + 1, middle, times_ns.end());
    return *middle / 5;
}

std::optional<NameStamps> stamps_of_names(const std::vector<std::string>& names) {
    NameStamps stamps;
    std::int64_t tick = 0;
    for (const std::string& name : names) {
        const std::string stem = std::filesystem::path(name).stem().string();
        const bool seconds = stem.find('.') != stem.npos;
        const std::int64_t own_tick = seconds ? -1 : tick_ns(stem.size());
        const auto value = seconds ? parse_seconds_as_ns(stem) : parse_int64(stem);
        const std::int64_t value_ns = seconds ? 1 : own_tick;
        if (own_tick == 0 || !value || *value < 0 || *value > kMaxStamp_ns / value_ns ||
            (tick != 0 && own_tick != tick))
            return std::nullopt;
        tick = own_tick;
        stamps.times_ns.push_back(*value * value_ns);
    }
    if (tick == 0) return std::nullopt;
    stamps.unit = tick == -1 ? "s" : tick == 1 ? "ns" : tick == 1'000 ? "us" : "ms";
    return stamps;
}

}  // namespace surefoot::io
