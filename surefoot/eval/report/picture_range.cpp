// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/picture_range.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace surefoot::eval {
namespace {

/// Percentiles that limit the shown range: a few outliers must not flatten the colours of all other
/// values.
constexpr double kLowShare = 0.01;
constexpr double kHighShare = 0.99;
constexpr double kSmallestRelativeSpan = 1e-6;

std::vector<float> known_values(const Image<float>& values) {
    std::vector<float> known;
    std::copy_if(
        values.data(), values.data() + values.size(), std::back_inserter(known), [](float value) {
            return std::isfinite(value);
        });
    return known;
}

double value_at_share(std::vector<float>& values, double share) {
    const double rank = std::round(share * static_cast<double>(values.size() - 1));
    // in range: from 0 to the last, as share is kLowShare or kHighShare
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), nth, values.end());
    return static_cast<double>(*nth);
}

}  // namespace

bool any_known(const Image<float>& values) {
    return std::any_of(values.data(), values.data() + values.size(), [](float value) {
        return std::isfinite(value);
    });
}

ValueRange shown_range(const Image<float>& values, const LayerStyle& style) {
    if (style.range) return *style.range;
    std::vector<float> known = known_values(values);
    if (known.empty()) return {0.0, 1.0};
    const double low = style.value_scale * value_at_share(known, kLowShare);
    const double high = style.value_scale * value_at_share(known, kHighShare);
    const double middle = 0.5 * (low + high);
    const double floor = kSmallestRelativeSpan * std::max(1.0, std::abs(middle));
    const double span = std::max({high - low, style.min_span, floor});
    return {middle - 0.5 * span, middle + 0.5 * span};
}

ColorBar color_bar_of(const Image<float>& values, const LayerStyle& style) {
    const ValueRange range = shown_range(values, style);
    ColorBar bar;
    bar.scale = {
        style.map, range.low, range.high, style.centre.value_or(0.5 * (range.low + range.high))};
    bar.unit = style.unit;
    bar.low_word = style.low_word;
    bar.high_word = style.high_word;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double shown = style.value_scale * static_cast<double>(values.data()[i]);
        if (!std::isfinite(shown)) continue;
        bar.clipped_low = bar.clipped_low || shown < range.low;
        bar.clipped_high = bar.clipped_high || shown > range.high;
    }
    return bar;
}

}  // namespace surefoot::eval
