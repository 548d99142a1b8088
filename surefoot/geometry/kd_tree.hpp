// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/point_box.hpp"

namespace surefoot::geometry {

/// A point of a tree with its squared distance from the query.
struct Neighbour {
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t index = kNone;  ///< index in `KdTree::points_m`
    float sq_distance_m2 = std::numeric_limits<float>::infinity();
};

/// Number of nodes that a search entered, and number of points that it compared.
struct SearchWork {
    std::size_t nodes = 0;
    std::size_t points = 0;
};

/// A cylinder, given by the middle of its axis.
struct Cylinder {
    Eigen::Vector3f middle_m = Eigen::Vector3f::Zero();
    Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();  ///< unit
    float radius_m = 0.0F;
    float half_length_m = 0.0F;
};

/// Balanced k-d tree over points (Bentley 1975; Friedman, Bentley and Finkel 1977). The tree
/// owns the points and stores them leaf by leaf, without an index: 12 bytes a point and one
/// to two bytes more for the nodes. Points are floats, relative to a near origin. Distances
/// equal those of a search through all points, to the last bit. Searches are const and
/// thread-safe.
///
/// Equal points form one leaf of any size, so that a cloud of copies is not slower than others.
///
/// The points must be finite and within `kFarthest_m` of zero along each axis. Their number must be
/// less than 2^32 - 1.
class KdTree {
  public:
    /// Distances up to this one [m] have finite squares as floats.
    static constexpr float kFarthest_m = 1e18F;

    explicit KdTree(std::vector<Eigen::Vector3f> points_m, Executor& executor = serial());

    [[nodiscard]] bool empty() const noexcept { return points_m_.empty(); }
    /// All points, in the order of the tree.
    [[nodiscard]] std::span<const Eigen::Vector3f> points_m() const noexcept { return points_m_; }

    /// Returns the nearest point, or `start` if no point is nearer. Also returns `start` if the
    /// query is so far away that the squared distance is not a finite float. A near start (for
    /// example the result of the previous query) makes the search short.
    [[nodiscard]] Neighbour nearest(const Eigen::Vector3f& query_m, Neighbour start = {}) const;
    /// Makes a `start` for `nearest` from point `index` and the query.
    [[nodiscard]] Neighbour neighbour(const Eigen::Vector3f& query_m, std::uint32_t index) const;

    /// Finds the nearest points, in order of distance; a query that is a tree point finds itself.
    /// Returns their number: `found.size()`, or the number of all points if that is smaller.
    std::size_t nearest(const Eigen::Vector3f& query_m, std::span<Neighbour> found) const;

    /// Returns the index of a point with exactly these coordinates, or `Neighbour::kNone`.
    [[nodiscard]] std::uint32_t find(const Eigen::Vector3f& point_m) const;

    /// Counts the nodes and points that a search for `neighbours` points, or `find`, visits. Tests
    /// use these counts: unlike times, they do not depend on the computer.
    [[nodiscard]] SearchWork work_of_nearest(const Eigen::Vector3f& query_m,
                                             std::size_t neighbours) const;
    [[nodiscard]] SearchWork work_of_find(const Eigen::Vector3f& point_m) const;

    /// Calls `visit(std::span<const Eigen::Vector3f> run, std::size_t copies)` with runs of points.
    /// The runs contain all points of the ball, and some outside it. Each point of a run stands for
    /// `copies` equal points.
    template <typename Visit>
    void runs_near_ball(const Eigen::Vector3f& middle_m, float radius_m, Visit&& visit) const {
        walk_ball(middle_m, radius_m, OnRun(visit));
    }
    /// Calls `visit` in the same way, with the runs near a cylinder.
    template <typename Visit>
    void runs_near_cylinder(const Cylinder& cylinder, Visit&& visit) const {
        walk_cylinder(cylinder, OnRun(visit));
    }

  private:
    using Run = std::span<const Eigen::Vector3f>;
    /// Reference to the visitor of a run.
    class OnRun {
      public:
        template <typename Visit>
        explicit OnRun(Visit& visit)
            : visit_(&visit), call_([](const void* v, Run run, std::size_t copies) {
                  (*static_cast<const Visit*>(v))(run, copies);
              }) {}
        void operator()(Run run, std::size_t copies) const { call_(visit_, run, copies); }

      private:
        const void* visit_;
        void (*call_)(const void*, Run, std::size_t);
    };
    static constexpr std::int32_t kAllEqual = -1;
    /// Left points end at `low_m`, right points begin at `high_m`. Searches never enter nodes below
    /// a node of equal points (`axis` is `kAllEqual`).
    struct Node {
        float low_m = 0.0F;
        float high_m = 0.0F;
        std::int32_t axis = 0;
    };

    void walk_ball(const Eigen::Vector3f& middle_m, float radius_m, OnRun on_run) const;
    void walk_cylinder(const Cylinder& cylinder, OnRun on_run) const;
    template <typename Region>
    void walk(const Region& region, std::uint32_t node, const PointBox& box, OnRun on_run) const;
    template <typename Search>
    void descend(Search& search, std::uint32_t node, Eigen::Vector3f& offset_m) const;
    [[nodiscard]] std::uint32_t find_below(std::uint32_t node,
                                           const Eigen::Vector3f& point_m,
                                           SearchWork& work) const;

    void cut(std::uint32_t node);
    void build(std::uint32_t node);
    /// Returns the index of the first point of node `number` of a level. Nodes share points evenly.
    [[nodiscard]] std::size_t first_of(int level, std::uint64_t number) const noexcept {
        return static_cast<std::size_t>((points_m_.size() * number) >> level);
    }
    [[nodiscard]] std::size_t first_in(std::uint32_t node) const noexcept;
    [[nodiscard]] Run points_in(std::uint32_t node) const noexcept;
    [[nodiscard]] bool is_leaf(std::uint32_t node) const noexcept;
    [[nodiscard]] bool all_equal(std::uint32_t node) const noexcept;
    [[nodiscard]] Eigen::Vector3f offset_to_box(const Eigen::Vector3f& query_m) const;

    std::vector<Eigen::Vector3f> points_m_;
    std::vector<Node> nodes_;  ///< children of i are 2 i and 2 i + 1; the root is 1
    int levels_ = 0;           ///< number of levels above the leaves
    PointBox box_;
};

}  // namespace surefoot::geometry
