// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/error_bins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/report/percentile.hpp"

namespace surefoot::eval {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Computes the statistics of `errors`, which must contain no NaN.
ErrorFigures figures_of(const std::vector<double>& errors) {
    if (errors.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone, 0};
    std::vector<double> absolute;
    absolute.reserve(errors.size());
    double sum = 0.0;
    double sum_sq = 0.0;
    for (const double error : errors) {
        absolute.push_back(std::abs(error));
        sum += error;
        sum_sq += error * error;
    }
    std::sort(absolute.begin(), absolute.end());
    const auto n = static_cast<double>(errors.size());
    return {percentile_of_sorted(absolute, 0.5),
            percentile_of_sorted(absolute, 0.9),
            percentile_of_sorted(absolute, 0.99),
            absolute.back(),
            sum / n,
            std::sqrt(sum_sq / n),
            static_cast<std::int64_t>(errors.size())};
}

/// Returns the number of the bin that holds `key`, or -1.
std::ptrdiff_t bin_of(double key, std::span<const double> edges) {
    if (!(key >= edges.front() && key <= edges.back())) return -1;
    const auto after = std::upper_bound(edges.begin(), edges.end(), key) - edges.begin();
    return std::min(after, static_cast<std::ptrdiff_t>(edges.size()) - 1) - 1;
}

}  // namespace

ErrorFigures error_figures(std::span<const float> errors) {
    std::vector<double> known;
    for (const float error : errors) {
        if (!std::isnan(error)) known.push_back(static_cast<double>(error));
    }
    return figures_of(known);
}

std::vector<ErrorBin> by_bins(std::span<const float> errors,
                              std::span<const float> keys,
                              std::span<const double> edges) {
    SUREFOOT_ASSERT(errors.size() == keys.size());
    if (edges.size() < 2) return {};
    std::vector<std::vector<double>> sorted_in(edges.size() - 1);
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const std::ptrdiff_t bin = bin_of(static_cast<double>(keys[i]), edges);
        if (bin < 0 || std::isnan(errors[i])) continue;
        sorted_in[static_cast<std::size_t>(bin)].push_back(static_cast<double>(errors[i]));
    }
    std::vector<ErrorBin> bins;
    for (std::size_t k = 0; k < sorted_in.size(); ++k) {
        ErrorHistogram histogram;
        for (const double error : sorted_in[k]) histogram.add(error);
        bins.push_back({edges[k], edges[k + 1], figures_of(sorted_in[k]), histogram});
    }
    return bins;
}

SigmaCoverage sigma_coverage(std::span<const float> errors, std::span<const float> sigmas) {
    SUREFOOT_ASSERT(errors.size() == sigmas.size());
    std::int64_t within[3] = {};
    std::int64_t count = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double error = std::abs(static_cast<double>(errors[i]));
        const auto sigma = static_cast<double>(sigmas[i]);
        if (std::isnan(error) || !std::isfinite(sigma) || sigma < 0.0) continue;
        ++count;
        for (int k = 0; k < 3; ++k) within[k] += error <= (k + 1) * sigma ? 1 : 0;
    }
    if (count == 0) return {kNone, kNone, kNone, 0};
    const auto share = [count](std::int64_t part) {
        return static_cast<double>(part) / static_cast<double>(count);
    };
    return {share(within[0]), share(within[1]), share(within[2]), count};
}

}  // namespace surefoot::eval
