// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/kd_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>

#include "surefoot/core/assert.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3f;

/// Largest number of points in a leaf. Searches of one million points were fastest with 8 to 16.
constexpr std::size_t kLeaf = 12;
/// Number of levels after which every branch is a separate piece of work.
constexpr int kParallelLevels = 5;
/// If a branch had fewer points than this, one thread builds the whole tree: threads would cost
/// more than they save.
constexpr std::size_t kSmallestPiece = 2048;
/// Factor for the rounding of a sum of three squares. A search in a ball also enters boxes that
/// miss the ball by no more than this rounding.
constexpr float kRounding = 1.0F - 4e-7F;

int level_of(std::uint32_t node) noexcept {
    return static_cast<int>(std::bit_width(node)) - 1;
}

/// Always sums in this order. Roundings are monotone: in floats, no point of a box is nearer than
/// the offset to the box. Searches therefore need no tolerance and can skip boxes at exactly the
/// distance of the current result. Otherwise copies of points, and surfaces far from the query,
/// would be searched completely.
float sq_norm(float dx, float dy, float dz) noexcept {
    return dx * dx + dy * dy + dz * dz;
}

float sq_norm(const Vector3f& d) noexcept {
    return sq_norm(d.x(), d.y(), d.z());
}

float sq_distance(const Vector3f& a, const Vector3f& b) noexcept {
    return sq_norm(a.x() - b.x(), a.y() - b.y(), a.z() - b.z());
}

/// Keeps one nearest point.
struct OneNearest {
    Vector3f query_m;
    Neighbour best;

    static void enter() noexcept {}
    [[nodiscard]] static std::size_t wanted() noexcept { return 1; }
    [[nodiscard]] float bound() const noexcept { return best.sq_distance_m2; }
    void scan(std::span<const Vector3f> run, std::size_t first) noexcept {
        for (std::size_t i = 0; i < run.size(); ++i) {
            const float sq = sq_distance(run[i], query_m);
            if (sq < best.sq_distance_m2) best = {static_cast<std::uint32_t>(first + i), sq};
        }
    }
};

/// Keeps several nearest points in order of distance. Sorts by insertion, because the points are
/// few.
struct SomeNearest {
    Vector3f query_m;
    std::span<Neighbour> found;
    std::size_t count = 0;

    static void enter() noexcept {}
    [[nodiscard]] std::size_t wanted() const noexcept { return found.size(); }
    [[nodiscard]] float bound() const noexcept {
        return count < found.size() ? std::numeric_limits<float>::infinity()
                                    : found.back().sq_distance_m2;
    }
    void scan(std::span<const Vector3f> run, std::size_t first) noexcept {
        for (std::size_t i = 0; i < run.size(); ++i) {
            const float sq = sq_distance(run[i], query_m);
            if (!(sq < bound())) continue;
            std::size_t at = count < found.size() ? count++ : count - 1;
            for (; at > 0 && found[at - 1].sq_distance_m2 > sq; --at) found[at] = found[at - 1];
            found[at] = {static_cast<std::uint32_t>(first + i), sq};
        }
    }
};

/// Counts the work of a search.
template <typename Search>
struct Counted : Search {
    SearchWork work;

    void enter() noexcept { ++work.nodes; }
    void scan(std::span<const Vector3f> run, std::size_t first) noexcept {
        work.points += run.size();
        Search::scan(run, first);
    }
};

}  // namespace

KdTree::KdTree(std::vector<Vector3f> points_m, Executor& executor)
    : points_m_(std::move(points_m)) {
    SUREFOOT_ASSERT(points_m_.size() < Neighbour::kNone);
    if (points_m_.empty()) return;
    while ((points_m_.size() >> levels_) + 1 > kLeaf) ++levels_;
    nodes_.resize(std::size_t{1} << levels_);
    box_ = box_of(points_m_);
    SUREFOOT_ASSERT(box_.low_m.minCoeff() >= -kFarthest_m && box_.high_m.maxCoeff() <= kFarthest_m);
    // The first levels are split one after the other, then each branch separately. The tree does
    // not depend on the number of threads.
    const int shared = points_m_.size() >> kParallelLevels < kSmallestPiece
                           ? 0
                           : std::min(levels_, kParallelLevels);
    for (int level = 0; level < shared; ++level) {
        executor.parallel_for(1 << level,
                              [&](int i) { cut((1U << level) + static_cast<std::uint32_t>(i)); });
    }
    executor.parallel_for(1 << shared,
                          [&](int i) { build((1U << shared) + static_cast<std::uint32_t>(i)); });
}

/// Splits the points of a node in two halves across the longest side of their box.
void KdTree::cut(std::uint32_t node) {
    const int level = level_of(node);
    const std::uint64_t number = node - (1U << level);
    const auto at = [&](std::size_t i) {
        return points_m_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    const auto first = at(first_of(level, number));
    const auto middle = at(first_of(level + 1, 2 * number + 1));
    const auto end = at(first_of(level, number + 1));
    const PointBox box = box_of({first, end});
    Eigen::Index axis = 0;
    if (!((box.high_m - box.low_m).maxCoeff(&axis) > 0.0F)) {
        nodes_[node].axis = kAllEqual;
        return;
    }
    std::nth_element(first, middle, end, [axis](const Vector3f& a, const Vector3f& b) {
        return a[axis] < b[axis];
    });
    float last_m = box.low_m[axis];
    for (auto p = first; p != middle; ++p) last_m = std::max(last_m, (*p)[axis]);
    nodes_[node] = {last_m, (*middle)[axis], static_cast<std::int32_t>(axis)};
}

void KdTree::build(std::uint32_t node) {
    if (level_of(node) == levels_) return;
    cut(node);
    if (all_equal(node)) return;
    build(2 * node);
    build(2 * node + 1);
}

bool KdTree::is_leaf(std::uint32_t node) const noexcept {
    return level_of(node) == levels_;
}

bool KdTree::all_equal(std::uint32_t node) const noexcept {
    return nodes_[node].axis == kAllEqual;
}

std::size_t KdTree::first_in(std::uint32_t node) const noexcept {
    const int level = level_of(node);
    return first_of(level, node - (1U << level));
}

KdTree::Run KdTree::points_in(std::uint32_t node) const noexcept {
    const int level = level_of(node);
    const std::size_t first = first_in(node);
    return Run(points_m_).subspan(first, first_of(level, node - (1U << level) + 1) - first);
}

/// `offset_m`: from the query to the box of the node, along each axis.
template <typename Search>
void KdTree::descend(Search& search, std::uint32_t node, Vector3f& offset_m) const {
    search.enter();
    if (is_leaf(node)) return search.scan(points_in(node), first_in(node));
    if (all_equal(node)) {
        const Run run = points_in(node);
        return search.scan(run.first(std::min(run.size(), search.wanted())), first_in(node));
    }
    const Node& cut = nodes_[node];
    const float at_m = search.query_m[cut.axis];
    const bool right = (at_m - cut.low_m) + (at_m - cut.high_m) >= 0.0F;
    descend(search, 2 * node + (right ? 1 : 0), offset_m);
    const float near_m = offset_m[cut.axis];
    offset_m[cut.axis] = right ? at_m - cut.low_m : cut.high_m - at_m;
    if (sq_norm(offset_m) < search.bound()) descend(search, 2 * node + (right ? 0 : 1), offset_m);
    offset_m[cut.axis] = near_m;
}

Neighbour KdTree::neighbour(const Vector3f& query_m, std::uint32_t index) const {
    return {index, sq_distance(points_m_[index], query_m)};
}

Neighbour KdTree::nearest(const Vector3f& query_m, Neighbour start) const {
    if (empty()) return start;
    OneNearest search{query_m, start};
    Vector3f offset_m = offset_to_box(query_m);
    descend(search, 1, offset_m);
    return search.best;
}

std::size_t KdTree::nearest(const Vector3f& query_m, std::span<Neighbour> found) const {
    if (empty() || found.empty()) return 0;
    SomeNearest search{query_m, found, 0};
    Vector3f offset_m = offset_to_box(query_m);
    descend(search, 1, offset_m);
    return search.count;
}

Vector3f KdTree::offset_to_box(const Vector3f& query_m) const {
    const Vector3f zero = Vector3f::Zero();
    return (box_.low_m - query_m).cwiseMax(query_m - box_.high_m).cwiseMax(zero);
}

SearchWork KdTree::work_of_nearest(const Vector3f& query_m, std::size_t neighbours) const {
    std::vector<Neighbour> found(neighbours);
    if (empty() || found.empty()) return {};
    Counted<SomeNearest> search{{query_m, found, 0}, {}};
    Vector3f offset_m = offset_to_box(query_m);
    descend(search, 1, offset_m);
    return search.work;
}

/// Compares coordinates, not distances: below 1e-23 m the squared distance of different points is
/// zero.
std::uint32_t KdTree::find_below(std::uint32_t node,
                                 const Vector3f& point_m,
                                 SearchWork& work) const {
    ++work.nodes;
    if (is_leaf(node) || all_equal(node)) {
        Run run = points_in(node);
        if (!is_leaf(node)) run = run.first(1);
        const auto same = std::find(run.begin(), run.end(), point_m);
        work.points += run.size();
        return same == run.end()
                   ? Neighbour::kNone
                   : static_cast<std::uint32_t>(first_in(node) +
                                                static_cast<std::size_t>(same - run.begin()));
    }
    const Node& cut = nodes_[node];
    std::uint32_t found = Neighbour::kNone;
    if (point_m[cut.axis] <= cut.low_m) found = find_below(2 * node, point_m, work);
    if (found == Neighbour::kNone && point_m[cut.axis] >= cut.high_m)
        found = find_below(2 * node + 1, point_m, work);
    return found;
}

std::uint32_t KdTree::find(const Vector3f& point_m) const {
    SearchWork work;
    return empty() ? Neighbour::kNone : find_below(1, point_m, work);
}

SearchWork KdTree::work_of_find(const Vector3f& point_m) const {
    SearchWork work;
    if (!empty()) static_cast<void>(find_below(1, point_m, work));
    return work;
}

/// Visits the leaves whose box may touch the region.
template <typename Region>
void KdTree::walk(const Region& region,
                  std::uint32_t node,
                  const PointBox& box,
                  OnRun on_run) const {
    if (!region.may_touch(box.low_m, box.high_m)) return;
    if (is_leaf(node)) return on_run(points_in(node), 1);
    if (all_equal(node)) return on_run(points_in(node).first(1), points_in(node).size());
    const Node& cut = nodes_[node];
    PointBox part = box;
    part.high_m[cut.axis] = cut.low_m;
    walk(region, 2 * node, part, on_run);
    part = box;
    part.low_m[cut.axis] = cut.high_m;
    walk(region, 2 * node + 1, part, on_run);
}

namespace {

struct BallRegion {
    Vector3f middle_m;
    float sq_radius_m2;

    [[nodiscard]] bool may_touch(const Vector3f& low_m, const Vector3f& high_m) const {
        const Vector3f zero = Vector3f::Zero();
        return (low_m - middle_m).cwiseMax(middle_m - high_m).cwiseMax(zero).squaredNorm() <=
               sq_radius_m2 / kRounding;
    }
};

/// Separating axes of a box and a cylinder: the axes of the box, the axis of the cylinder and two
/// across it (Ericson 2005, Real-Time Collision Detection, 5.2.1). Further axes cost more than they
/// save.
class CylinderRegion {
  public:
    explicit CylinderRegion(const Cylinder& c) : middle_m_(c.middle_m) {
        axes_.col(0) = c.axis;
        axes_.col(1) = c.axis.unitOrthogonal();
        axes_.col(2) = c.axis.cross(axes_.col(1));
        reach_m_ = {c.half_length_m, c.radius_m, c.radius_m};
        const Vector3f across = (Vector3f::Ones() - c.axis.cwiseAbs2()).cwiseMax(0.0F).cwiseSqrt();
        box_m_ = c.half_length_m * c.axis.cwiseAbs() + c.radius_m * across;
        // Upper bound of the rounding errors of coordinates of this size.
        const Vector3f most = middle_m_.cwiseAbs() + box_m_;
        slack_m_ = 1e-6F * most.maxCoeff();
    }
    [[nodiscard]] bool may_touch(const Vector3f& low_m, const Vector3f& high_m) const {
        const Vector3f to_m = 0.5F * (low_m + high_m) - middle_m_;
        const Vector3f half_m = 0.5F * (high_m - low_m) + Vector3f::Constant(slack_m_);
        if ((to_m.cwiseAbs() - half_m - box_m_).maxCoeff() > 0.0F) return false;
        const Vector3f along_m = (axes_.transpose() * to_m).cwiseAbs();
        const Vector3f box_along_m = axes_.cwiseAbs().transpose() * half_m;
        return (along_m - box_along_m - reach_m_).maxCoeff() <= 0.0F;
    }

  private:
    Vector3f middle_m_;
    Eigen::Matrix3f axes_;
    Vector3f reach_m_;  ///< half extent of the cylinder along each column of `axes_`
    Vector3f box_m_;    ///< half extent of the cylinder along x, y and z
    float slack_m_ = 0.0F;
};

}  // namespace

void KdTree::walk_ball(const Vector3f& middle_m, float radius_m, OnRun on_run) const {
    if (!empty()) walk(BallRegion{middle_m, radius_m * radius_m}, 1, box_, on_run);
}

void KdTree::walk_cylinder(const Cylinder& cylinder, OnRun on_run) const {
    if (!empty()) walk(CylinderRegion{cylinder}, 1, box_, on_run);
}

}  // namespace surefoot::geometry
