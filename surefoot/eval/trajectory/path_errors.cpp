// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/trajectory/path_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/assert.hpp"

namespace surefoot::eval {
namespace {

/// Largest deviation of a stretch from the requested length, as a share: evo's rel_delta_tol.
constexpr double kLengthTolerance = 0.1;

/// Returns the true path length [m] from the first matched pose to each matched pose.
std::vector<double> path_so_far_m(const Trajectory& truth, const std::vector<PosePair>& pairs) {
    std::vector<double> path_m;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto position_m = [&](std::size_t pair) {
            return truth[pairs[pair].truth].T_world_body.translation_m;
        };
        path_m.push_back(k == 0 ? 0.0 : path_m.back() + (position_m(k) - position_m(k - 1)).norm());
    }
    return path_m;
}

/// Finds the pair after `start` whose true path length from `start` is nearest to `length_m`.
/// Returns no value if this length deviates too much (`kLengthTolerance`).
std::optional<std::size_t> stretch_end(const std::vector<double>& path_m,
                                       std::size_t start,
                                       double length_m) {
    const auto first = path_m.begin() + static_cast<std::ptrdiff_t>(start) + 1;
    if (first == path_m.end()) return std::nullopt;
    const double wanted_m = path_m[start] + length_m;
    auto end = std::lower_bound(first, path_m.end(), wanted_m);
    if (end == path_m.end() || (end != first && wanted_m - *(end - 1) <= *end - wanted_m)) {
        end = std::lower_bound(
            first, end, *(end - 1));  // of several poses without motion between them, the earliest
    }
    if (std::abs(*end - wanted_m) > kLengthTolerance * length_m) return std::nullopt;
    return static_cast<std::size_t>(end - path_m.begin());
}

}  // namespace

std::vector<PathError> errors_over_path(const Trajectory& estimate,
                                        const Trajectory& truth,
                                        const std::vector<PosePair>& pairs,
                                        const std::vector<double>& lengths_m) {
    const auto path_m = path_so_far_m(truth, pairs);
    std::vector<PathError> errors;
    for (const double length_m : lengths_m) {
        SUREFOOT_ASSERT(length_m > 0.0);
        double trans_sq_m2 = 0.0;
        double ratio_sq = 0.0;
        double rot_sq_deg2 = 0.0;
        std::int64_t count = 0;
        for (std::size_t start = 0; start < pairs.size(); ++start) {
            const auto end = stretch_end(path_m, start, length_m);
            if (!end) continue;
            const Pose error = relative_error(estimate, truth, pairs[start], pairs[*end]);
            const double stretch_m = path_m[*end] - path_m[start];
            trans_sq_m2 += error.translation_m.squaredNorm();
            ratio_sq += error.translation_m.squaredNorm() / (stretch_m * stretch_m);
            const double angle_deg = kDegPerRad * log_so3(error.rotation).norm();
            rot_sq_deg2 += angle_deg * angle_deg;
            ++count;
        }
        const auto n =
            count == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(count);
        errors.push_back({length_m,
                          std::sqrt(trans_sq_m2 / n),
                          std::sqrt(rot_sq_deg2 / n),
                          100.0 * std::sqrt(ratio_sq / n),
                          count});
    }
    return errors;
}

}  // namespace surefoot::eval
