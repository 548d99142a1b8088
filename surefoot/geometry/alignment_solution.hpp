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

/// About what a step turns, and how far from it the points typically lie: six unknowns in metres,
/// a shift and the turn times this length.
struct Lever {
    Eigen::Vector3d pivot_m = Eigen::Vector3d::Zero();
    double length_m = 1.0;

    /// How the distance across a pair grows with the six unknowns.
    [[nodiscard]] Vector6d row(const Pair& pair) const;
};

/// What a direction can be held by. A kind holds only what those before it leave free: surfaces
/// err by their noise; edges, where both surfaces end between two points, by the spacing of the
/// points; borders may be no more than where a scan ends.
enum class HeldBy : std::uint8_t { surfaces, edges, borders };
inline constexpr std::size_t kHolds = 3;
/// Of a pair from `SurfacePairs` (surfaces, edges) or `BorderPairs`; 0 where it does not count.
[[nodiscard]] double weight_as(HeldBy kind, const Pair& pair) noexcept;

/// Least squares of the distances across pairs, as one kind.
struct Normals6 {
    Matrix6d left = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    double sq_across_m2 = 0.0;
    double sq_apart_m2 = 0.0;
    std::int64_t pairs = 0;  ///< that count, whatever their weight

    void add(HeldBy kind, const Pair& pair, const Lever& lever);
    void add(const Normals6& other);
};
/// The same for any number of threads.
[[nodiscard]] Normals6 sum_up(HeldBy kind,
                              std::span<const Pair> pairs,
                              const Lever& lever,
                              Executor& executor);

/// A step along the directions that are held; each kind adds gain * (right - left * x).
struct AlignmentSolution {
    Vector6d x = Vector6d::Zero();
    std::array<Matrix6d, kHolds> gain{Matrix6d::Zero(), Matrix6d::Zero(), Matrix6d::Zero()};
    std::array<int, kHolds> directions{};
    int free_directions = 6;
};
[[nodiscard]] AlignmentSolution solve(const std::array<Normals6, kHolds>& sums);

/// One sigma of the place of the lever's pivot and of the turn.
struct AlignmentSigma {
    double place_m = 0.0;
    double turn_rad = 0.0;
};
/// Two kinds of error are added up. Scatter: each pair's own distance counts (White 1980), times
/// what pairs of one neighbourhood err together (sums over blocks against sums over pairs; Liang
/// and Zeger 1986), since the noise of one normal is in all its pairs. What more pairs do not mend:
/// edges and borders lie where the last point of a row lies, up to half a spacing off in each
/// cloud, and may all be off together (`cell_var_m2`, variance along each direction that they
/// hold); a scan that ends elsewhere draws a border by up to a tenth of its balls' radius.
[[nodiscard]] AlignmentSigma alignment_sigma(std::span<const Pair> surface,
                                             std::span<const Pair> border,
                                             const Lever& lever,
                                             const AlignmentSolution& solution,
                                             double cell_var_m2);

}  // namespace surefoot::geometry
