// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/cloud_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/core/assert.hpp"
#include "surefoot/geometry/alignment_pairs.hpp"
#include "surefoot/geometry/alignment_solution.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<Vector3f> taken_evenly(std::span<const Vector3f> points_m, int most) {
    const auto limit = static_cast<std::size_t>(most);
    const std::size_t count = std::min(points_m.size(), limit);
    std::vector<Vector3f> taken_m;
    taken_m.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        taken_m.push_back(points_m[i * points_m.size() / count]);
    return taken_m;
}

/// Scales rotations to the shift that they cause at the typical distance from the centre.
Lever lever_of(std::span<const Vector3f> points_m) {
    const auto n = static_cast<double>(points_m.size());
    Lever lever;
    for (const Vector3f& p_m : points_m) lever.pivot_m += p_m.cast<double>();
    lever.pivot_m /= n;
    double sq_size_m2 = 0.0;
    for (const Vector3f& p_m : points_m)
        sq_size_m2 += (p_m.cast<double>() - lever.pivot_m).squaredNorm();
    const double size_m = std::sqrt(sq_size_m2 / n);
    lever.length_m = size_m > 0.0 ? size_m : 1.0;
    return lever;
}

/// Applies a step to the pose: rotates about the pivot, then shifts.
void apply(const Vector6d& x, const Lever& lever, Pose& T) {
    const Eigen::Quaterniond turn = exp_so3(x.tail<3>() / lever.length_m);
    T.translation_m = turn * (T.translation_m - lever.pivot_m) + lever.pivot_m + x.head<3>();
    T.rotation = (turn * T.rotation).normalized();
}

/// Number of different reference points in pairs: many pairs with one point count once.
std::int64_t points_paired_with(std::span<const Pair> pairs) {
    std::vector<std::uint32_t> points;
    for (const Pair& pair : pairs) {
        if (pair.counts) points.push_back(pair.reference);
    }
    std::sort(points.begin(), points.end());
    return std::unique(points.begin(), points.end()) - points.begin();
}

/// Share of the moved points that lie at points of the reference. Such a point is no farther from
/// its nearest reference point than the radius of that point's ball of neighbours plus three times
/// `rms_m`.
double overlap_of(std::span<const Pair> pairs, double rms_m) {
    std::int64_t there = 0;
    for (const Pair& pair : pairs) {
        const double reach_m = pair.ball_m + 3.0 * rms_m;
        if (pair.counts && pair.sq_apart_m2 <= reach_m * reach_m) ++there;
    }
    return static_cast<double>(there) / static_cast<double>(pairs.size());
}

/// Variance of the position of a surface's end, which lies anywhere between two points of a cloud.
/// Takes the point spacing from a sample of the points.
double cell_var_m2(const KdTree& cloud) {
    constexpr std::size_t kAsked = 2000;
    constexpr int kOthers = 30;
    const auto points_m = cloud.points_m();
    const std::size_t asked = std::min(points_m.size(), kAsked);
    std::vector<Pair> balls(asked);
    std::vector<Neighbour> near(kOthers + 1);
    for (std::size_t i = 0; i < asked; ++i) {
        const std::size_t count = cloud.nearest(points_m[i * points_m.size() / asked], near);
        balls[i].ball_m = std::sqrt(static_cast<double>(near[count - 1].sq_distance_m2));
        balls[i].counts = true;
    }
    const double cell_m = spacing_m(median_over(balls, &Pair::ball_m), kOthers);
    return cell_m * cell_m / 12.0;
}

/// Decides whether the result is valid. There must be at least 30 points more than unknowns: the
/// scatter then gives sigma to 13 %.
AlignmentOutcome outcome_of(const CloudAlignment& found, bool settled, std::int64_t points) {
    constexpr std::int64_t kFewestToSpare = 30;
    constexpr double kLeastOverlap = 0.05;
    if (found.free_directions == 6) return AlignmentOutcome::no_pairs;
    if (found.overlap < kLeastOverlap) return AlignmentOutcome::no_overlap;
    if (points - (6 - found.free_directions) < kFewestToSpare)
        return AlignmentOutcome::too_few_points;
    return settled ? AlignmentOutcome::converged : AlignmentOutcome::not_settled;
}

}  // namespace

CloudAlignment align_clouds(const KdTree& reference,
                            std::span<const Vector3f> moved_m,
                            const Pose& T_reference_moved_guess,
                            const AlignmentConfig& config,
                            Executor& executor) {
    SUREFOOT_ASSERT(!reference.empty() && !moved_m.empty());
    SUREFOOT_ASSERT(config.kept_share > 0.0 && config.kept_share <= 1.0);
    std::vector<Vector3f> taken_m = taken_evenly(moved_m, config.most_points);
    const Lever moved_lever = lever_of(taken_m);
    const KdTree moved(taken_m, executor);
    CloudAlignment result;
    Pose& T = result.T_reference_moved = T_reference_moved_guess;
    SurfacePairs pairs(reference, std::move(taken_m), config, executor);
    std::optional<BorderPairs> borders;
    if (config.borders) borders.emplace(reference, moved, pairs.moved_m(), executor);
    Lever lever = moved_lever;
    AlignmentSolution solution;
    bool settled = false;
    while (!settled && static_cast<int>(result.steps.size()) < config.most_iterations) {
        lever.pivot_m = T * moved_lever.pivot_m;
        const std::vector<Pair>& now = pairs.at(T);
        const std::array<Normals6, kHolds> sums{
            sum_up(HeldBy::surfaces, now, lever, executor),
            sum_up(HeldBy::edges, now, lever, executor),
            borders ? sum_up(HeldBy::borders, borders->at(T, now), lever, executor) : Normals6{}};
        solution = solve(sums);
        apply(solution.x, lever, T);
        const auto n = static_cast<double>(std::max<std::int64_t>(sums[0].pairs, 1));
        result.steps.push_back({sums[0].pairs,
                                sums[2].pairs,
                                std::sqrt(sums[0].sq_across_m2 / n),
                                std::sqrt(sums[0].sq_apart_m2 / n),
                                solution.x.head<3>().norm(),
                                solution.x.tail<3>().norm() / lever.length_m});
        if (solution.free_directions == 6) break;
        settled = result.steps.back().step_m < config.smallest_step_m &&
                  result.steps.back().step_rad < config.smallest_step_rad;
    }
    result.edge_directions = solution.directions[1];
    result.border_directions = solution.directions[2];
    result.free_directions = solution.free_directions;
    const std::span<const Pair> ends =
        borders ? std::span(borders->last()) : std::span<const Pair>();
    const AlignmentSigma sigma = alignment_sigma(
        pairs.last(), ends, lever, solution, cell_var_m2(reference) + cell_var_m2(moved));
    result.sigma_m = sigma.place_m;
    result.sigma_rad = sigma.turn_rad;
    if (!result.steps.empty()) {
        const AlignmentStep& last = result.steps.back();
        result.overlap = overlap_of(pairs.last(), last.rms_m);
        // If pairs switch back and forth, the steps never become small enough. So the alignment
        // also counts as converged if the step is small against its sigma.
        constexpr double kShare = 0.1;
        settled = settled || (last.step_m < kShare * result.sigma_m &&
                              last.step_rad < kShare * result.sigma_rad);
    }
    result.outcome = outcome_of(result, settled, points_paired_with(pairs.last()));
    return result;
}

}  // namespace surefoot::geometry
