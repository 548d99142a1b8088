// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/alignment_pairs.hpp"

namespace surefoot::geometry {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// About what a step turns, and how far from it the points typically lie: six unknowns in metres,
/// a shift and the turn times this lever.
struct Lever {
    Eigen::Vector3d pivot_m = Eigen::Vector3d::Zero();
    double length_m = 1.0;

    /// How the distance across a pair grows with the six unknowns.
    [[nodiscard]] Vector6d row(const Pair& pair) const;
};

/// Least squares of the distances across the surface.
struct Normals6 {
    Matrix6d left = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    double sq_across_m2 = 0.0;
    double sq_apart_m2 = 0.0;
    std::int64_t pairs = 0;

    void add(const Pair& pair, const Lever& lever);
    void add(const Normals6& other);
};
/// The same for any number of threads.
[[nodiscard]] Normals6 sum_up(std::span<const Pair> pairs, const Lever& lever, Executor& executor);

/// A step along the directions that are held: x = surface_gain * right, and what borders add.
struct AlignmentSolution {
    Vector6d x = Vector6d::Zero();
    Matrix6d surface_gain = Matrix6d::Zero();
    Matrix6d border_gain = Matrix6d::Zero();
    int border_directions = 0;
    int free_directions = 0;
};
/// Directions that surfaces hold are theirs; borders, which may be no more than where a scan ends,
/// say something about the others alone.
[[nodiscard]] AlignmentSolution solve(const Normals6& surface, const Normals6& border);

/// How the points of a cloud lie to each other.
struct Sampling {
    double spacing_m = 0.0;   ///< of a square lattice with as many points
    double regularity = 0.0;  ///< 0: at random; 1: on a lattice
};
/// Of some thousand points, taken evenly.
[[nodiscard]] Sampling sampling_of(const KdTree& cloud);

/// One sigma of the place of the lever's pivot and of the turn.
struct AlignmentSigma {
    double place_m = 0.0;
    double turn_rad = 0.0;
};
/// Three kinds of error are added up. Scatter: each pair's own distance counts (White 1980), times
/// what pairs of one neighbourhood err together (sums over blocks against sums over pairs; Liang
/// and Zeger 1986): noise of one normal is in all its pairs. Lattices: edges between surfaces, and
/// borders, lie where the last point of a row lies, up to half a cell off, and on a lattice all of
/// them may be off together; so the pairs at edges count as moved as a whole by the scatter of a
/// cell of both clouds (cell^2 / 12 each). Ends: a scan that ends elsewhere draws a border by up to
/// a tenth of its balls' radius.
[[nodiscard]] AlignmentSigma alignment_sigma(std::span<const Pair> surface,
                                             std::span<const Pair> border,
                                             const Lever& lever,
                                             const AlignmentSolution& solution,
                                             const Sampling& reference,
                                             const Sampling& moved);

}  // namespace surefoot::geometry
