// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/sparsification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/assert.hpp"

namespace surefoot::eval {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Least difference between random and oracle area, as a share of the random area. A smaller
/// difference is a rounding error of the sums: all errors are equal.
constexpr double kEqualAreas = 1e-12;

struct Value {
    double key = 0.0;  ///< value that defines the order
    double error = 0.0;
};

/// Returns the mean of E(m) over all m: E(m) is the mean error of the m values with the smallest
/// keys.
double area_under(std::vector<Value>& values) {
    // Sorting by error within equal keys makes the sums independent of the order of the input.
    std::sort(values.begin(), values.end(), [](const Value& a, const Value& b) {
        return a.key != b.key ? a.key < b.key : a.error < b.error;
    });
    double sum_before = 0.0;
    double area = 0.0;
    for (std::size_t begin = 0; begin < values.size();) {
        std::size_t end = begin;
        double group_sum = 0.0;
        while (end < values.size() && values[end].key == values[begin].key) {
            group_sum += values[end++].error;
        }
        const double group_mean = group_sum / static_cast<double>(end - begin);
        for (std::size_t m = begin + 1; m <= end; ++m) {
            const double sum = sum_before + static_cast<double>(m - begin) * group_mean;
            area += sum / static_cast<double>(m);
        }
        sum_before += group_sum;
        begin = end;
    }
    return area / static_cast<double>(values.size());
}

}  // namespace

Sparsification sparsification(std::span<const float> errors, std::span<const float> sigmas) {
    SUREFOOT_ASSERT(errors.size() == sigmas.size());
    std::vector<Value> values;
    double sum = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        if (!std::isfinite(errors[i]) || !std::isfinite(sigmas[i])) continue;
        values.push_back(
            {static_cast<double>(sigmas[i]), std::abs(static_cast<double>(errors[i]))});
        sum += values.back().error;
    }
    if (values.empty()) return {kNone, kNone, kNone, kNone, 0};
    Sparsification result;
    result.count = static_cast<std::int64_t>(values.size());
    result.random_area = sum / static_cast<double>(values.size());
    result.area = area_under(values);
    for (Value& value : values) value.key = value.error;
    result.oracle_area = area_under(values);
    const double span = result.random_area - result.oracle_area;
    result.auc = span <= kEqualAreas * result.random_area
                     ? kNone
                     : (result.area - result.oracle_area) / span;
    return result;
}

}  // namespace surefoot::eval
