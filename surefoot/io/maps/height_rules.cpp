// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/height_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "surefoot/core/height_limit.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::io {
namespace {

/// Smallest gap between a "no data" mark and all other heights. A map for a walking machine has no
/// hole or tower of this height without intermediate heights.
constexpr double kFar_m = 50.0;
constexpr double kFarOfRange = 10.0;
/// Largest number of "no data" marks in a file; most files have one mark.
constexpr int kMostMarks = 4;

std::int64_t replace(std::span<float> heights_m, double low_m, double high_m) {
    std::int64_t cells = 0;
    for (float& height_m : heights_m) {
        const auto z_m = static_cast<double>(height_m);
        if (!(z_m >= low_m && z_m <= high_m)) continue;
        height_m = kNanF;
        ++cells;
    }
    return cells;
}

bool is_usual_mark(double value) {
    constexpr double kMarks[] = {-9999.0,
                                 9999.0,
                                 -99999.0,
                                 99999.0,
                                 -999.0,
                                 -9999.9,
                                 -999.9,
                                 -999.99,
                                 -32768.0,
                                 -32767.0,
                                 32767.0,
                                 65535.0};
    return std::any_of(std::begin(kMarks), std::end(kMarks), [&](double mark) {
        return std::abs(value - mark) <= 1e-6 * std::abs(mark);  // equal within float precision
    });
}

/// The two lowest and the two highest different values.
struct Ends {
    double lowest = std::numeric_limits<double>::infinity();
    double second_lowest = std::numeric_limits<double>::infinity();
    double second_highest = -std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
};

Ends ends_of(std::span<const float> heights_m) {
    Ends e;
    for (const float height_m : heights_m) {
        const auto z_m = static_cast<double>(height_m);
        if (!std::isfinite(z_m)) continue;
        if (z_m < e.lowest) {
            e.second_lowest = std::exchange(e.lowest, z_m);
        } else if (z_m > e.lowest && z_m < e.second_lowest) {
            e.second_lowest = z_m;
        }
        if (z_m > e.highest) {
            e.second_highest = std::exchange(e.highest, z_m);
        } else if (z_m < e.highest && z_m > e.second_highest) {
            e.second_highest = z_m;
        }
    }
    return e;
}

/// Returns a height that marks "no data"; no value if the layer has no such height.
std::optional<double> find_mark(std::span<const float> heights_m) {
    const Ends e = ends_of(heights_m);
    if (!(e.lowest <= e.highest)) return std::nullopt;
    if (e.lowest == e.highest) {
        return is_usual_mark(e.lowest) ? std::optional(e.lowest) : std::nullopt;
    }
    const auto is_mark = [](double value, double gap_m, double range_m) {
        return gap_m > kFar_m && (is_usual_mark(value) || gap_m > kFarOfRange * range_m);
    };
    const bool low = is_mark(e.lowest, e.second_lowest - e.lowest, e.highest - e.second_lowest);
    const bool high = is_mark(e.highest, e.highest - e.second_highest, e.second_highest - e.lowest);
    if (low && high) return std::abs(e.lowest) >= std::abs(e.highest) ? e.lowest : e.highest;
    if (low) return e.lowest;
    return high ? std::optional(e.highest) : std::nullopt;
}

}  // namespace

std::vector<std::string> drop_impossible_heights(grid::Layer& heights_m) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double beyond_m = std::nextafter(kMaxHeight_m, kInfinity);
    const std::span<float> all_m(heights_m.data(), heights_m.size());
    std::vector<std::string> notes;
    if (const std::int64_t cells =
            replace(all_m, beyond_m, kInfinity) + replace(all_m, -kInfinity, -beyond_m);
        cells > 0) {
        notes.push_back(fmt::format(
            "{} cells have heights of more than {:g} m above or below 0; these cells are unknown",
            cells,
            kMaxHeight_m));
    }
    for (int i = 0; i < kMostMarks; ++i) {
        const auto mark = find_mark(all_m);
        if (!mark) break;
        const std::int64_t cells = replace(all_m, *mark, *mark);
        notes.push_back(fmt::format(
            "{} cells hold {:g} m, which differs by more than {:g} m from all other heights. The "
            "program takes this value for a 'no data' mark, and these cells are unknown",
            cells,
            *mark,
            kFar_m));
    }
    return notes;
}

}  // namespace surefoot::io
