// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/geometry/kd_tree.hpp"
#include "surefoot/geometry/surface_normal.hpp"

namespace surefoot::geometry {

struct AlignmentConfig;

/// Points that one thread takes, and that are summed at once.
inline constexpr std::size_t kAlignmentPiece = 2048;

/// Something of the moved cloud that should lie on something of the reference: a point on a
/// surface, or where the cloud ends.
struct Pair {
    Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< moved, as it lies now
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double across_m = 0.0;
    double sq_apart_m2 = 0.0;
    double weight = 1.0;
    /// Share of the pair that lies at an edge between surfaces, where the normal is that of
    /// neither.
    double edge = 0.0;
    double ball_m = 0.0;       ///< radius of the neighbours that gave the normal, or of the border
    double thickness_m = 0.0;  ///< of those neighbours across the surface
    std::uint32_t reference = Neighbour::kNone;
    bool counts = false;
};

/// Distance of the neighbours in a square lattice, of which so many others lie in such a ball.
[[nodiscard]] double spacing_m(double ball_m, int others) noexcept;
/// Median over the pairs that count; 0 without one.
[[nodiscard]] double median_over(std::span<const Pair> pairs, double Pair::*value);

/// Pairs of nearest points. Asked again and again, it keeps the normals that it knows.
class SurfacePairs {
  public:
    SurfacePairs(const KdTree& reference,
                 std::vector<Eigen::Vector3f> moved_m,
                 const AlignmentConfig& config,
                 Executor& executor);

    const std::vector<Pair>& at(const Pose& T_reference_moved);
    [[nodiscard]] const std::vector<Pair>& last() const noexcept { return pairs_; }
    [[nodiscard]] const std::vector<Eigen::Vector3f>& moved_m() const noexcept { return moved_m_; }

  private:
    struct Known {
        std::uint32_t index = Neighbour::kNone;
        std::optional<LocalSurface> surface;
        float ball_m = 0.0F;
    };
    void pair_up(std::size_t i, const Pose& T_reference_moved);
    [[nodiscard]] Known surface_at(std::uint32_t index) const;
    void keep_nearest();
    void find_edges();

    const KdTree& reference_;
    std::vector<Eigen::Vector3f> moved_m_;
    const AlignmentConfig& config_;
    Executor& executor_;
    std::vector<Pair> pairs_;
    std::vector<Known> nearest_;  ///< of each moved point: most keep theirs from step to step
};

/// Where the moved cloud ends: points whose neighbours lie to one side. What is compared are the
/// middles of what both clouds have within the same ball; a border moves them, and points in the
/// middle of a surface do not.
class BorderPairs {
  public:
    /// `moved`: the tree of the points `moved_m`.
    BorderPairs(const KdTree& reference,
                const KdTree& moved,
                const std::vector<Eigen::Vector3f>& moved_m,
                Executor& executor);

    /// `surface`: the pairs of the points, whose normals tell what lies within the surface.
    const std::vector<Pair>& at(const Pose& T_reference_moved, const std::vector<Pair>& surface);
    [[nodiscard]] const std::vector<Pair>& last() const noexcept { return pairs_; }

  private:
    struct Border {
        std::size_t index;  ///< of the point
        float radius_m;
        Eigen::Vector3d to_middle_m;  ///< in the axes of the moved cloud
    };
    [[nodiscard]] Pair pair_up(const Border& border, const Pose& T, const Pair& surface) const;

    const KdTree& reference_;
    Executor& executor_;
    std::vector<Border> borders_;
    std::vector<Pair> pairs_;
};

}  // namespace surefoot::geometry
