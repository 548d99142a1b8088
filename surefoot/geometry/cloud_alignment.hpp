// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::geometry {

struct AlignmentConfig {
    int most_iterations = 100;
    /// Points of the moved cloud that are used, taken evenly; all where there are fewer.
    int most_points = 100000;
    int normal_neighbours = 30;  ///< of a reference point, that give its normal
    /// Pairs farther apart than this do not count [m]; 0 = all do.
    double reach_m = 0.0;
    /// Share of the pairs that count, nearest first, in (0, 1]. Less than 1 where the clouds do not
    /// cover each other; it also gives up what holds weak directions.
    double kept_share = 1.0;
    /// Directions along all surfaces are held by borders that both clouds have.
    bool borders = true;
    double smallest_step_m = 1e-5;  ///< with less than both the alignment has converged
    double smallest_step_rad = 1e-5;
};

/// One iteration: what its pairs said before the step, and the step.
struct AlignmentStep {
    std::int64_t pairs = 0;
    std::int64_t borders = 0;    ///< points on a border of both clouds
    double rms_m = 0.0;          ///< of the distances across the reference's surface
    double nearest_rms_m = 0.0;  ///< of the distances between the points of a pair
    double step_m = 0.0;
    double step_rad = 0.0;
};

/// Whether an alignment is an answer, and if not, why.
enum class AlignmentOutcome : std::uint8_t {
    converged,
    no_pairs,        ///< no pair counts: beyond the reach, or no surface anywhere
    too_few_points,  ///< hardly more points than unknowns: nothing would contradict a wrong answer
    no_overlap,      ///< fewer than 5 % of the moved points lie where the reference has points
    not_settled,     ///< still moving after the most iterations
};
inline constexpr std::array<std::string_view, 5> kAlignmentOutcomeNames{
    "converged", "no_pairs", "too_few_points", "no_overlap", "not_settled"};

struct CloudAlignment {
    Pose T_reference_moved;
    AlignmentOutcome outcome = AlignmentOutcome::no_pairs;
    /// Directions of the six (three of them turns) along all surfaces: those that edges hold, where
    /// two surfaces end between points, as the faces of steps do in a height map; those that the
    /// borders of the clouds hold alone; and those that nothing holds: there the guess stays as it
    /// was. A bare floor has three of them together.
    int edge_directions = 0;
    int border_directions = 0;
    int free_directions = 0;
    /// One sigma of where the middle of the moved cloud lies and of the turn (`alignment_sigma`):
    /// of the directions that something holds. Meaningless unless `converged()`.
    double sigma_m = 0.0;
    double sigma_rad = 0.0;
    /// Share of the moved points that lie where the reference has points.
    double overlap = 0.0;
    std::vector<AlignmentStep> steps;

    [[nodiscard]] bool converged() const noexcept { return outcome == AlignmentOutcome::converged; }
};

/// Iterative closest point with distances across the reference's surface (Chen and Medioni 1992;
/// Besl and McKay 1992 for the pairs): of points on stairs and floors those to the nearest *point*
/// slide by the spacing of the points. Along stairs that have no side walls surfaces hold nothing;
/// there the places where both clouds end are brought together, if the guess has them within some
/// spacings of each other. The same result for any number of threads, and in every run.
/// The moved cloud and the reference must not be empty; points are finite.
[[nodiscard]] CloudAlignment align_clouds(const KdTree& reference,
                                          std::span<const Eigen::Vector3f> moved_m,
                                          const Pose& T_reference_moved_guess,
                                          const AlignmentConfig& config,
                                          Executor& executor = serial());

}  // namespace surefoot::geometry
