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
    /// Largest number of moved points that are used. Of a larger cloud, evenly spaced indices.
    int most_points = 100000;
    int normal_neighbours = 30;  ///< neighbours of a reference point that give its normal
    /// Pairs farther apart than this [m] do not count; 0 = all pairs count.
    double reach_m = 0.0;
    /// Share of pairs that count, nearest first, in (0, 1]. Use less than 1 for clouds that do not
    /// cover each other. A small share can also remove the few pairs that fix a weak direction.
    double kept_share = 1.0;
    /// Whether common borders of both clouds fix directions that surfaces and edges leave free.
    bool borders = true;
    double smallest_step_m = 1e-5;  ///< converged below this, or below a tenth of `sigma_m`
    double smallest_step_rad = 1e-5;
};

/// One iteration: its pairs before the step, and the step.
struct AlignmentStep {
    std::int64_t pairs = 0;
    std::int64_t borders = 0;    ///< number of points on a border of both clouds
    double rms_m = 0.0;          ///< rms of the distances across the surface of the reference
    double nearest_rms_m = 0.0;  ///< rms of the distances between the points of a pair
    double step_m = 0.0;
    double step_rad = 0.0;
};

/// Result class of an alignment: success, or the reason of failure.
enum class AlignmentOutcome : std::uint8_t {
    converged,
    no_pairs,        ///< no pair counts: all pairs are too far apart, or no surface was found
    too_few_points,  ///< paired points minus fixed directions below 30: sigma is unreliable
    no_overlap,      ///< fewer than 5 % of the moved points lie where the reference has points
    not_settled,     ///< the steps are still too large after `most_iterations`
};
inline constexpr std::array<std::string_view, 5> kAlignmentOutcomeNames{
    "converged", "no_pairs", "too_few_points", "no_overlap", "not_settled"};

struct CloudAlignment {
    Pose T_reference_moved;
    AlignmentOutcome outcome = AlignmentOutcome::no_pairs;
    /// How many of the six directions (three shifts, three rotations) are fixed by edges (ends of
    /// surfaces between points, as at steps in a height map), are fixed only by borders of the
    /// clouds, or stay free. Surfaces fix the rest. Free directions keep the guess. On a bare floor
    /// the three numbers add up to three.
    int edge_directions = 0;
    int border_directions = 0;
    int free_directions = 0;
    /// One sigma of the position of the moved cloud's centre and of the rotation
    /// (`alignment_sigma`), for the fixed directions only. Meaningless unless `converged()`.
    double sigma_m = 0.0;
    double sigma_rad = 0.0;
    /// Share of the moved points that lie at points of the reference.
    double overlap = 0.0;
    std::vector<AlignmentStep> steps;

    [[nodiscard]] bool converged() const noexcept { return outcome == AlignmentOutcome::converged; }
};

/// Iterative closest point with point-to-plane distances (Chen and Medioni 1992; pairs as in
/// Besl and McKay 1992). Point-to-point distances on stairs and floors would slip by the point
/// spacing. On stairs without side walls, surfaces leave the sideways direction free. The
/// borders of both clouds then fix it, if the guess is within some point spacings. The result is
/// the same for every number of threads and in every run. The clouds must not be empty; points
/// are finite.
[[nodiscard]] CloudAlignment align_clouds(const KdTree& reference,
                                          std::span<const Eigen::Vector3f> moved_m,
                                          const Pose& T_reference_moved_guess,
                                          const AlignmentConfig& config,
                                          Executor& executor = serial());

}  // namespace surefoot::geometry
