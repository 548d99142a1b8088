// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/alignment_pairs.hpp"

namespace surefoot::geometry {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Pivot of the rotation of a step, and the typical distance of the points from it. All six
/// unknowns are in metres: a shift, and the rotation times this length.
struct Lever {
    Eigen::Vector3d pivot_m = Eigen::Vector3d::Zero();
    double length_m = 1.0;

    /// Returns the derivative of the distance across a pair by the six unknowns.
    [[nodiscard]] Vector6d row(const Pair& pair) const;
};

/// Kinds of evidence that fix a direction. Each kind fixes only directions that earlier kinds leave
/// free. Surfaces err by their noise. Edges (both surfaces end between two points) err by the point
/// spacing. A border may be the end of a scan and not of an object.
enum class HeldBy : std::uint8_t { surfaces, edges, borders };
inline constexpr std::size_t kHolds = 3;
/// Returns the weight of a pair as evidence of this kind. `borders` needs pairs of `BorderPairs`.
[[nodiscard]] double weight_as(HeldBy kind, const Pair& pair) noexcept;

/// Normal equations of the distances across the pairs of one kind of evidence.
struct Normals6 {
    Matrix6d left = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    double sq_across_m2 = 0.0;
    double sq_apart_m2 = 0.0;
    std::int64_t pairs = 0;  ///< number of pairs that count, also with weight 0

    void add(HeldBy kind, const Pair& pair, const Lever& lever);
    void add(const Normals6& other);
};
/// Sums over all pairs. The result does not depend on the number of threads.
[[nodiscard]] Normals6 sum_up(HeldBy kind,
                              std::span<const Pair> pairs,
                              const Lever& lever,
                              Executor& executor);

/// A step along the fixed directions. Each kind adds gain * (right - left * x).
struct AlignmentSolution {
    Vector6d x = Vector6d::Zero();
    std::array<Matrix6d, kHolds> gain{Matrix6d::Zero(), Matrix6d::Zero(), Matrix6d::Zero()};
    std::array<int, kHolds> directions{};
    int free_directions = 6;
};
[[nodiscard]] AlignmentSolution solve(const std::array<Normals6, kHolds>& sums);

/// One sigma of the position of the lever's pivot and of the rotation.
struct AlignmentSigma {
    double place_m = 0.0;
    double turn_rad = 0.0;
};
/// Adds two kinds of error. First, the scatter of the pairs from their squared distances (White
/// 1980). It is increased, because pairs in one cube of space share the noise of a normal (Liang
/// and Zeger 1986). Second, the errors that more pairs do not reduce. Edges and borders lie up to
/// half a point spacing off in each cloud, perhaps all in one direction; `cell_var_m2` is their
/// variance per fixed direction. If the other scan ends elsewhere, a border is also shifted, by up
/// to a tenth of the radius of its balls.
[[nodiscard]] AlignmentSigma alignment_sigma(std::span<const Pair> surface,
                                             std::span<const Pair> border,
                                             const Lever& lever,
                                             const AlignmentSolution& solution,
                                             double cell_var_m2);

}  // namespace surefoot::geometry
