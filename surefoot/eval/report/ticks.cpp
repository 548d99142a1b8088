// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::eval {
namespace {

/// Relative tolerance for the rounding error of a quotient, so that a tick exactly at the end of
/// the range stays.
constexpr double kRounding = 1e-9;

}  // namespace

double nice_below(double value) {
    SUREFOOT_ASSERT(value > 0.0 && std::isfinite(value));
    const double decade = std::pow(10.0, std::floor(std::log10(value) + kRounding));
    const double leading = value / decade * (1.0 + kRounding);
    if (leading >= 5.0) return 5.0 * decade;
    return leading >= 2.0 ? 2.0 * decade : decade;
}

Ticks nice_ticks(double low, double high, int target) {
    SUREFOOT_ASSERT(std::isfinite(low) && std::isfinite(high) && low < high && target > 0);
    const double smallest = (high - low) / target;
    Ticks ticks;
    // Finds the smallest round number that is not below `smallest`.
    ticks.step = nice_below(smallest);
    if (ticks.step * (1.0 + kRounding) < smallest) ticks.step = nice_below(2.5 * ticks.step);
    // in range: nice_below() gives a finite number above 0, whose logarithm is within 324 of 0
    ticks.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(ticks.step) + kRounding)));
    const double first = std::ceil(low / ticks.step - kRounding);
    const double last = std::floor(high / ticks.step + kRounding);
    for (double k = first; k <= last; k += 1.0) ticks.values.push_back(k * ticks.step);
    return ticks;
}

std::string Ticks::label(double value) const {
    // Adding zero turns -0 into 0.
    const double rounded = std::round(value / step) * step + 0.0;
    return fmt::format("{:.{}f}", rounded, decimals);
}

}  // namespace surefoot::eval
