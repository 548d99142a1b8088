// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/cloud_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/pieces.hpp"
#include "surefoot/geometry/surface_normal.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kTaken = 2048;  ///< points that one thread takes, and that are summed at once

std::vector<Vector3f> taken_evenly(std::span<const Vector3f> points_m, int most) {
    const auto limit = static_cast<std::size_t>(most);
    const std::size_t count = std::min(points_m.size(), limit);
    std::vector<Vector3f> taken_m;
    taken_m.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        taken_m.push_back(points_m[i * points_m.size() / count]);
    return taken_m;
}

/// Something of the moved cloud that should lie on something of the reference: a point on a
/// surface, or where the cloud ends.
struct Pair {
    Vector3d at_m = Vector3d::Zero();  ///< moved, as it lies now
    Vector3d normal = Vector3d::Zero();
    double across_m = 0.0;
    double sq_apart_m2 = 0.0;
    double weight = 1.0;
    bool counts = false;
};

/// What is asked of the surface again and again: which point is nearest, and its normal.
class Pairing {
  public:
    Pairing(const KdTree& reference,
            std::vector<Vector3f> moved_m,
            const AlignmentConfig& config,
            Executor& executor)
        : reference_(reference),
          moved_m_(std::move(moved_m)),
          config_(config),
          executor_(executor),
          pairs_(moved_m_.size()),
          nearest_(moved_m_.size()) {}

    const std::vector<Pair>& pairs_at(const Pose& T_reference_moved) {
        in_pieces(moved_m_.size(),
                  kTaken,
                  executor_,
                  [&](std::size_t begin, std::size_t end, std::size_t) {
                      for (std::size_t i = begin; i < end; ++i) pair_up(i, T_reference_moved);
                  });
        if (config_.kept_share < 1.0) keep_nearest();
        return pairs_;
    }
    [[nodiscard]] const std::vector<Vector3f>& moved_m() const noexcept { return moved_m_; }

  private:
    void pair_up(std::size_t i, const Pose& T_reference_moved) {
        Pair& pair = pairs_[i];
        pair.at_m = T_reference_moved * moved_m_[i].cast<double>();
        const Vector3f query_m = pair.at_m.cast<float>();
        Known& known = nearest_[i];
        const Neighbour start = known.index == Neighbour::kNone
                                    ? Neighbour{}
                                    : reference_.neighbour(query_m, known.index);
        const Neighbour found = reference_.nearest(query_m, start);
        if (found.index != known.index) known = {found.index, normal_at(found.index)};
        const Vector3d to_m = pair.at_m - reference_.points_m()[found.index].cast<double>();
        pair.sq_apart_m2 = to_m.squaredNorm();
        pair.counts =
            known.normal.has_value() &&
            (config_.reach_m == 0.0 || pair.sq_apart_m2 <= config_.reach_m * config_.reach_m);
        if (!pair.counts) return;
        pair.normal = known.normal->cast<double>();
        pair.across_m = pair.normal.dot(to_m);
    }
    [[nodiscard]] std::optional<Vector3f> normal_at(std::uint32_t index) const {
        std::vector<Neighbour> near(static_cast<std::size_t>(config_.normal_neighbours) + 1);
        const Vector3f& p_m = reference_.points_m()[index];
        const std::size_t count = reference_.nearest(p_m, near);
        return surface_normal(reference_, p_m, std::sqrt(near[count - 1].sq_distance_m2));
    }
    /// The share of the pairs that counts; of pairs that are as far apart as the last, all do.
    void keep_nearest() {
        std::vector<double> sq_apart_m2;
        for (const Pair& pair : pairs_) {
            if (pair.counts) sq_apart_m2.push_back(pair.sq_apart_m2);
        }
        if (sq_apart_m2.empty()) return;
        const auto last = static_cast<std::ptrdiff_t>(config_.kept_share *
                                                      static_cast<double>(sq_apart_m2.size() - 1));
        std::nth_element(sq_apart_m2.begin(), sq_apart_m2.begin() + last, sq_apart_m2.end());
        const double limit_m2 = sq_apart_m2[static_cast<std::size_t>(last)];
        for (Pair& pair : pairs_) pair.counts = pair.counts && pair.sq_apart_m2 <= limit_m2;
    }

    struct Known {
        std::uint32_t index = Neighbour::kNone;
        std::optional<Vector3f> normal;
    };
    const KdTree& reference_;
    std::vector<Vector3f> moved_m_;
    const AlignmentConfig& config_;
    Executor& executor_;
    std::vector<Pair> pairs_;
    std::vector<Known> nearest_;  ///< of each moved point: most keep theirs from step to step
};

/// Where the moved cloud ends: points whose neighbours lie to one side. What is compared are the
/// middles of what both clouds have within the same ball; a border moves them, and points in the
/// middle of a surface do not.
class Borders {
  public:
    Borders(const KdTree& reference, const Pairing& pairing, Executor& executor)
        : reference_(reference), executor_(executor) {
        const std::vector<Vector3f>& points_m = pairing.moved_m();
        const KdTree moved(points_m, executor);
        std::vector<std::optional<Border>> found(points_m.size());
        in_pieces(points_m.size(),
                  kTaken,
                  executor,
                  [&](std::size_t begin, std::size_t end, std::size_t) {
                      std::vector<Neighbour> near(kNeighbours);
                      for (std::size_t i = begin; i < end; ++i) {
                          const std::size_t count = moved.nearest(points_m[i], near);
                          const float radius_m = std::sqrt(near[count - 1].sq_distance_m2);
                          const auto off_m = to_middle(moved, points_m[i], radius_m);
                          if (off_m && off_m->norm() > kCandidate * static_cast<double>(radius_m))
                              found[i] = Border{i, radius_m, *off_m};
                      }
                  });
        for (const auto& border : found) {
            if (border) borders_.push_back(*border);
        }
        pairs_.resize(borders_.size());
    }

    /// `surface`: the pairs of the points, whose normals tell what lies within the surface.
    const std::vector<Pair>& pairs_at(const Pose& T, const std::vector<Pair>& surface) {
        in_pieces(borders_.size(),
                  kTaken,
                  executor_,
                  [&](std::size_t begin, std::size_t end, std::size_t) {
                      for (std::size_t i = begin; i < end; ++i)
                          pairs_[i] = pair_up(borders_[i], T, surface[borders_[i].index]);
                  });
        return pairs_;
    }

  private:
    struct Border {
        std::size_t index;  ///< of the point
        float radius_m;
        Vector3d to_middle_m;  ///< in the axes of the moved cloud
    };
    static constexpr std::size_t kNeighbours = 31;
    /// The middle of half a disc lies 0.42 of its radius off; that of 30 points of a whole one by
    /// chance 0.09. What is asked of both clouds together favours neither: a limit on each by
    /// itself would draw a border towards where chance has it. From the first share on a pair
    /// begins to count, at the second it counts wholly, so that no small step changes much.
    static constexpr double kBegins = 0.3;
    static constexpr double kWhole = 0.35;
    /// Of one cloud, to be looked at: together with half a disc of the other it just counts.
    static constexpr double kCandidate = 0.18;

    static std::optional<Vector3d> to_middle(const KdTree& cloud,
                                             const Vector3f& at_m,
                                             float radius_m) {
        Vector3d sum_m = Vector3d::Zero();
        int count = 0;
        cloud.runs_near_ball(at_m, radius_m, [&](std::span<const Vector3f> run) {
            for (const Vector3f& p_m : run) {
                if ((p_m - at_m).squaredNorm() > radius_m * radius_m) continue;
                sum_m += (p_m - at_m).cast<double>();
                ++count;
            }
        });
        constexpr int kFewest = 5;
        if (count < kFewest) return std::nullopt;
        return sum_m / count;
    }
    [[nodiscard]] Pair pair_up(const Border& border, const Pose& T, const Pair& surface) const {
        Pair pair;
        if (!surface.counts) return pair;
        const auto within = [&](const Vector3d& v) -> Vector3d {
            return v - surface.normal.dot(v) * surface.normal;
        };
        const auto radius_m = static_cast<double>(border.radius_m);
        const Vector3d moved_m = within(T.rotation * border.to_middle_m);
        const auto reference = to_middle(reference_, surface.at_m.cast<float>(), border.radius_m);
        if (!reference || !(moved_m.norm() > 0.0)) return pair;
        pair.normal = moved_m.normalized();
        const double there_m = pair.normal.dot(*reference);
        const double share = 0.5 * (moved_m.norm() + there_m) / radius_m;
        pair.weight = std::clamp((share - kBegins) / (kWhole - kBegins), 0.0, 1.0);
        if (pair.weight == 0.0) return pair;
        pair.at_m = surface.at_m;
        pair.across_m = moved_m.norm() - there_m;
        pair.sq_apart_m2 = pair.across_m * pair.across_m;
        pair.counts = true;
        return pair;
    }

    const KdTree& reference_;
    Executor& executor_;
    std::vector<Border> borders_;
    std::vector<Pair> pairs_;
};

/// Least squares of the distances across the surface, turns about `pivot_m`.
struct Normals6 {
    Matrix6d left = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    double sq_across_m2 = 0.0;
    double sq_apart_m2 = 0.0;
    std::int64_t pairs = 0;

    void add(const Pair& pair, const Vector3d& pivot_m, double lever_m) {
        Vector6d j;
        j << pair.normal, (pair.at_m - pivot_m).cross(pair.normal) / lever_m;
        left += pair.weight * j * j.transpose();
        right -= pair.weight * pair.across_m * j;
        sq_across_m2 += pair.across_m * pair.across_m;
        sq_apart_m2 += pair.sq_apart_m2;
        ++pairs;
    }
    void add(const Normals6& other) {
        left += other.left;
        right += other.right;
        sq_across_m2 += other.sq_across_m2;
        sq_apart_m2 += other.sq_apart_m2;
        pairs += other.pairs;
    }
};

Normals6 sum_up(const std::vector<Pair>& pairs,
                const Vector3d& pivot_m,
                double lever_m,
                Executor& executor) {
    std::vector<Normals6> parts(pieces_of(pairs.size(), kTaken));
    in_pieces(
        pairs.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, std::size_t piece) {
            for (std::size_t i = begin; i < end; ++i) {
                if (pairs[i].counts) parts[piece].add(pairs[i], pivot_m, lever_m);
            }
        });
    Normals6 all;
    for (const Normals6& part : parts) all.add(part);
    return all;
}

/// A step along the directions that are held, and how well surfaces hold it.
struct Step {
    Vector6d x = Vector6d::Zero();  ///< metres; turns are in metres at the lever
    int border_directions = 0;
    int free_directions = 0;
    double var_place = 0.0;  ///< per squared scatter
    double var_turn = 0.0;
};

/// Directions that surfaces hold are theirs; borders, which may be no more than where a scan ends,
/// say something about the others alone.
Step solve(const Normals6& surface, const Normals6& border) {
    // Normals of noisy points are off by some degrees: what they seem to hold of a direction along
    // the surface is the square of that. A wall across it holds as much with one point in 200.
    constexpr double kHeld = 5e-3;
    constexpr double kHeldByBorders = 5e-2;
    constexpr std::int64_t kFewestBorders = 30;
    Step step;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(surface.left);
    int along = 0;  // eigenvalues ascend
    for (int i = 0; i < 6; ++i) {
        const double value = eigen.eigenvalues()[i];
        if (!(value > kHeld * static_cast<double>(surface.pairs))) {
            ++along;
            continue;
        }
        const Vector6d v = eigen.eigenvectors().col(i);
        step.x += v * (v.dot(surface.right) / value);
        step.var_place += v.head<3>().squaredNorm() / value;
        step.var_turn += v.tail<3>().squaredNorm() / value;
    }
    step.free_directions = along;
    if (along == 0 || border.pairs < kFewestBorders) return step;
    const Eigen::MatrixXd rest = eigen.eigenvectors().leftCols(along);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> inner(rest.transpose() * border.left *
                                                               rest);
    const Vector6d right = border.right - border.left * step.x;
    for (int i = 0; i < along; ++i) {
        const double value = inner.eigenvalues()[i];
        if (!(value > kHeldByBorders * static_cast<double>(border.pairs))) continue;
        const Vector6d v = rest * inner.eigenvectors().col(i);
        step.x += v * (v.dot(right) / value);
        ++step.border_directions;
        --step.free_directions;
    }
    return step;
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
    Vector3d middle_m = Vector3d::Zero();
    for (const Vector3f& p_m : taken_m) middle_m += p_m.cast<double>();
    middle_m /= static_cast<double>(taken_m.size());
    double sq_size_m2 = 0.0;
    for (const Vector3f& p_m : taken_m) sq_size_m2 += (p_m.cast<double>() - middle_m).squaredNorm();
    // Turns count as what they move at the typical distance from the middle.
    const double size_m = std::sqrt(sq_size_m2 / static_cast<double>(taken_m.size()));
    const double lever_m = size_m > 0.0 ? size_m : 1.0;

    CloudAlignment result;
    result.T_reference_moved = T_reference_moved_guess;
    Pairing pairing(reference, std::move(taken_m), config, executor);
    std::optional<Borders> borders;
    if (config.borders) borders.emplace(reference, pairing, executor);
    while (!result.converged && static_cast<int>(result.steps.size()) < config.most_iterations) {
        Pose& T = result.T_reference_moved;
        const Vector3d pivot_m = T * middle_m;
        const std::vector<Pair>& pairs = pairing.pairs_at(T);
        const Normals6 sums = sum_up(pairs, pivot_m, lever_m, executor);
        const Normals6 ends =
            borders ? sum_up(borders->pairs_at(T, pairs), pivot_m, lever_m, executor) : Normals6{};
        const Step step = solve(sums, ends);
        const Vector3d turn_rad = step.x.tail<3>() / lever_m;
        const Eigen::Quaterniond turn = exp_so3(turn_rad);
        T.translation_m = turn * (T.translation_m - pivot_m) + pivot_m + step.x.head<3>();
        T.rotation = (turn * T.rotation).normalized();
        const auto n = static_cast<double>(std::max<std::int64_t>(sums.pairs, 1));
        const double rms_m = std::sqrt(sums.sq_across_m2 / n);
        result.steps.push_back({sums.pairs,
                                ends.pairs,
                                rms_m,
                                std::sqrt(sums.sq_apart_m2 / n),
                                step.x.head<3>().norm(),
                                turn_rad.norm()});
        result.border_directions = step.border_directions;
        result.free_directions = step.free_directions;
        result.sigma_m = rms_m * std::sqrt(step.var_place);
        result.sigma_rad = rms_m * std::sqrt(step.var_turn) / lever_m;
        if (step.free_directions == 6) break;
        result.converged = result.steps.back().step_m < config.smallest_step_m &&
                           result.steps.back().step_rad < config.smallest_step_rad;
    }
    return result;
}

}  // namespace surefoot::geometry
