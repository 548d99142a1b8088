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

/// Number of points of one piece of work. A thread takes a piece and sums it up at once.
inline constexpr std::size_t kAlignmentPiece = 2048;

/// A point or border of the moved cloud, paired with the position of the reference cloud on which
/// it should lie.
struct Pair {
    Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< moved point at its current position
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double across_m = 0.0;
    double sq_apart_m2 = 0.0;
    double weight = 1.0;
    /// Degree in [0, 1] to which the pair lies at an edge between two surfaces. At an edge the
    /// normal belongs to neither surface.
    double edge = 0.0;
    double ball_m = 0.0;       ///< radius of the ball that gives the normal or the border
    double thickness_m = 0.0;  ///< rms distance of the points in the ball from the surface
    std::uint32_t reference = Neighbour::kNone;
    bool counts = false;
};

/// Returns the spacing of a square lattice with `others` + 1 points in a disc of radius `ball_m`.
[[nodiscard]] double spacing_m(double ball_m, int others) noexcept;
/// Returns the median over the pairs that count, or 0 if no pair counts.
[[nodiscard]] double median_over(std::span<const Pair> pairs, double Pair::*value);

/// Pairs of nearest points. Keeps the normals of known points between calls of `at`.
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
    std::vector<Known> nearest_;  ///< data of the nearest reference point of each moved point
};

/// Border of the moved cloud: points whose neighbours lie to one side. A pair compares the means of
/// the points of both clouds within the same ball. A border shifts this mean; the interior of a
/// surface does not.
class BorderPairs {
  public:
    /// `moved`: the k-d tree of the points `moved_m`.
    BorderPairs(const KdTree& reference,
                const KdTree& moved,
                const std::vector<Eigen::Vector3f>& moved_m,
                Executor& executor);

    /// `surface`: the pairs of the same points. Their normals define the plane of the surface.
    const std::vector<Pair>& at(const Pose& T_reference_moved, const std::vector<Pair>& surface);
    [[nodiscard]] const std::vector<Pair>& last() const noexcept { return pairs_; }

  private:
    struct Border {
        std::size_t index;  ///< index of the point
        float radius_m;
        Eigen::Vector3d to_middle_m;  ///< from the point to the mean of its neighbours, moved axes
    };
    [[nodiscard]] Pair pair_up(const Border& border, const Pose& T, const Pair& surface) const;

    const KdTree& reference_;
    Executor& executor_;
    std::vector<Border> borders_;
    std::vector<Pair> pairs_;
};

}  // namespace surefoot::geometry
