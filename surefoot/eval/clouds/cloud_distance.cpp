// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/cloud_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/pieces.hpp"
#include "surefoot/geometry/spatial_order.hpp"

namespace surefoot::eval {
namespace {

/// Number of points that are sorted at once (kSorted), and number of points in one task of a thread
/// (kTaken).
constexpr std::size_t kSorted = 1U << 20U;
constexpr std::size_t kTaken = 1U << 13U;

double between_ranks(std::vector<float>& values, double fraction) {
    const double rank = fraction * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::ptrdiff_t>(rank);  // in range: 0 to the last rank
    std::nth_element(values.begin(), values.begin() + below, values.end());
    const double low = static_cast<double>(values[static_cast<std::size_t>(below)]);
    const double weight = rank - static_cast<double>(below);
    if (weight == 0.0) return low;
    const double high =
        static_cast<double>(*std::min_element(values.begin() + below + 1, values.end()));
    return (1.0 - weight) * low + weight * high;
}

}  // namespace

std::vector<float> cloud_distances_m(const geometry::KdTree& reference,
                                     std::span<const Eigen::Vector3f> compared_m,
                                     Executor& executor) {
    SUREFOOT_ASSERT(!reference.empty());
    using geometry::Neighbour;
    std::vector<float> distances_m(compared_m.size());
    for (std::size_t from = 0; from < compared_m.size(); from += kSorted) {
        const auto points_m = compared_m.subspan(from, std::min(kSorted, compared_m.size() - from));
        const std::vector<std::uint32_t> order = geometry::spatial_order(points_m);
        in_pieces(order.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, auto) {
            Neighbour last;
            for (std::size_t i = begin; i < end; ++i) {
                const Eigen::Vector3f& p_m = points_m[order[i]];
                // The nearest neighbour of the previous point is a good start for this point.
                const Neighbour start = last.index == Neighbour::kNone
                                            ? Neighbour{}
                                            : reference.neighbour(p_m, last.index);
                last = reference.nearest(p_m, start);
                if (last.index ==
                    Neighbour::kNone) {  // the square of the distance overflows a float
                    distances_m[from + order[i]] = std::numeric_limits<float>::infinity();
                    continue;
                }
                const Eigen::Vector3d off_m =
                    p_m.cast<double>() - reference.points_m()[last.index].cast<double>();
                distances_m[from + order[i]] = static_cast<float>(off_m.norm());
            }
        });
    }
    return distances_m;
}

DistanceFigures distance_figures(std::span<const float> distances_m) {
    std::vector<float> values;
    values.reserve(distances_m.size());
    std::copy_if(distances_m.begin(), distances_m.end(), std::back_inserter(values), [](float d) {
        return !std::isnan(d);
    });
    DistanceFigures figures;
    figures.count = static_cast<std::int64_t>(values.size());
    if (values.empty()) {
        const double none = std::numeric_limits<double>::quiet_NaN();
        return {0, none, none, none, none, none, none, none, none, none, none};
    }
    const auto n = static_cast<double>(values.size());
    double sum_m = 0.0;
    double sum_sq_m2 = 0.0;
    for (const float value : values) {
        const auto d_m = static_cast<double>(value);
        sum_m += d_m;
        sum_sq_m2 += d_m * d_m;
    }
    figures.mean_m = sum_m / n;
    figures.rms_m = std::sqrt(sum_sq_m2 / n);
    double scatter_m2 = 0.0;
    for (const float value : values) {
        const double off_m = static_cast<double>(value) - figures.mean_m;
        scatter_m2 += off_m * off_m;
    }
    figures.std_m = std::sqrt(scatter_m2 / n);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    figures.least_m = static_cast<double>(*least);
    figures.most_m = static_cast<double>(*most);
    figures.p50_m = between_ranks(values, 0.5);
    figures.p90_m = between_ranks(values, 0.9);
    figures.p99_m = between_ranks(values, 0.99);
    for (float& value : values) value = std::abs(value);
    figures.median_abs_m = between_ranks(values, 0.5);
    figures.p90_abs_m = between_ranks(values, 0.9);
    return figures;
}

}  // namespace surefoot::eval
