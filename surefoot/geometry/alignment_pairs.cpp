// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/alignment_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/pieces.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kBorderNeighbours = 31;
/// Limits of the offset at a border: the distance from a point to the mean of its neighbours,
/// divided by the radius of their ball. The offset is 0.42 for half a disc of points, and 0.09 by
/// chance for 30 points of a whole disc. The limits apply to the mean offset of both clouds: a
/// limit on each cloud alone would draw a border towards its chance offset. The weight of a pair
/// grows from 0 at kBegins to 1 at kWhole, so that small steps change little.
constexpr double kBegins = 0.3;
constexpr double kWhole = 0.35;
/// Smallest offset at which a point of the moved cloud is a candidate. If the reference has an
/// offset of 0.42 there (half a disc), the mean of both offsets is kBegins.
constexpr double kCandidate = 0.18;

std::optional<Vector3d> to_middle(const KdTree& cloud, const Vector3f& at_m, float radius_m) {
    Vector3d sum_m = Vector3d::Zero();
    double count = 0.0;
    const auto add = [&](std::span<const Vector3f> run, std::size_t copies) {
        const auto weight = static_cast<double>(copies);
        for (const Vector3f& p_m : run) {
            if ((p_m - at_m).squaredNorm() > radius_m * radius_m) continue;
            sum_m += weight * (p_m - at_m).cast<double>();
            count += weight;
        }
    };
    cloud.runs_near_ball(at_m, radius_m, add);
    constexpr double kFewest = 5.0;
    if (count < kFewest) return std::nullopt;
    return sum_m / count;
}

}  // namespace

double spacing_m(double ball_m, int others) noexcept {
    return ball_m * std::sqrt(M_PI / (others + 1.0));
}

double median_over(std::span<const Pair> pairs, double Pair::*value) {
    std::vector<double> values;
    for (const Pair& pair : pairs) {
        if (pair.counts) values.push_back(pair.*value);
    }
    if (values.empty()) return 0.0;
    return upper_median_in_place(values);
}

SurfacePairs::SurfacePairs(const KdTree& reference,
                           std::vector<Vector3f> moved_m,
                           const AlignmentConfig& config,
                           Executor& executor)
    : reference_(reference),
      moved_m_(std::move(moved_m)),
      config_(config),
      executor_(executor),
      pairs_(moved_m_.size()),
      nearest_(moved_m_.size()) {}

const std::vector<Pair>& SurfacePairs::at(const Pose& T_reference_moved) {
    in_pieces(moved_m_.size(), kAlignmentPiece, executor_, [&](auto begin, auto end, auto) {
        for (std::size_t i = begin; i < end; ++i) pair_up(i, T_reference_moved);
    });
    if (config_.kept_share < 1.0) keep_nearest();
    find_edges();
    return pairs_;
}

void SurfacePairs::pair_up(std::size_t i, const Pose& T_reference_moved) {
    Pair& pair = pairs_[i];
    pair.at_m = T_reference_moved * moved_m_[i].cast<double>();
    const Vector3f query_m = pair.at_m.cast<float>();
    Known& known = nearest_[i];
    const Neighbour start =
        known.index == Neighbour::kNone ? Neighbour{} : reference_.neighbour(query_m, known.index);
    const Neighbour found = reference_.nearest(query_m, start);
    pair.reference = found.index;
    pair.counts = false;
    if (found.index == Neighbour::kNone) return;
    if (found.index != known.index) known = surface_at(found.index);
    const Vector3d to_m = pair.at_m - reference_.points_m()[found.index].cast<double>();
    pair.sq_apart_m2 = to_m.squaredNorm();
    pair.ball_m = static_cast<double>(known.ball_m);
    pair.counts = known.surface.has_value() &&
                  (config_.reach_m == 0.0 || pair.sq_apart_m2 <= config_.reach_m * config_.reach_m);
    if (!pair.counts) return;
    pair.normal = known.surface->normal.cast<double>();
    pair.thickness_m = static_cast<double>(known.surface->thickness_m);
    pair.across_m = pair.normal.dot(to_m);
}

SurfacePairs::Known SurfacePairs::surface_at(std::uint32_t index) const {
    std::vector<Neighbour> near(static_cast<std::size_t>(config_.normal_neighbours) + 1);
    const Vector3f& p_m = reference_.points_m()[index];
    const std::size_t count = reference_.nearest(p_m, near);
    near.resize(count);
    return {
        index, surface_of_neighbours(reference_, p_m, near), std::sqrt(near.back().sq_distance_m2)};
}

/// Keeps the nearest share of the pairs. Pairs as far apart as the last kept pair stay too.
void SurfacePairs::keep_nearest() {
    std::vector<double> sq_apart_m2;
    for (const Pair& pair : pairs_) {
        if (pair.counts) sq_apart_m2.push_back(pair.sq_apart_m2);
    }
    if (sq_apart_m2.empty()) return;
    // in range: align_clouds() asserts that kept_share is in (0, 1]
    const auto last = static_cast<std::ptrdiff_t>(config_.kept_share *
                                                  static_cast<double>(sq_apart_m2.size() - 1));
    std::nth_element(sq_apart_m2.begin(), sq_apart_m2.begin() + last, sq_apart_m2.end());
    const double limit_m2 = sq_apart_m2[static_cast<std::size_t>(last)];
    for (Pair& pair : pairs_) pair.counts = pair.counts && pair.sq_apart_m2 <= limit_m2;
}

/// Sets `edge` of each pair. A ball that is thicker than twice the median thickness may contain
/// points of two surfaces. Above this limit, `edge` grows from 0 to 1 over an eighth of the point
/// spacing.
void SurfacePairs::find_edges() {
    constexpr double kNoise = 2.0;
    constexpr double kShare = 0.125;
    const double noise_m = kNoise * median_over(pairs_, &Pair::thickness_m);
    const double wide_m =
        kShare * spacing_m(median_over(pairs_, &Pair::ball_m), config_.normal_neighbours);
    for (Pair& pair : pairs_) {
        pair.edge =
            wide_m > 0.0 ? std::clamp((pair.thickness_m - noise_m) / wide_m, 0.0, 1.0) : 0.0;
    }
}

BorderPairs::BorderPairs(const KdTree& reference,
                         const KdTree& moved,
                         const std::vector<Vector3f>& moved_m,
                         Executor& executor)
    : reference_(reference), executor_(executor) {
    std::vector<std::optional<Border>> found(moved_m.size());
    in_pieces(moved_m.size(), kAlignmentPiece, executor, [&](auto begin, auto end, auto) {
        std::vector<Neighbour> near(kBorderNeighbours);
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t count = moved.nearest(moved_m[i], near);
            const float radius_m = std::sqrt(near[count - 1].sq_distance_m2);
            const auto off_m = to_middle(moved, moved_m[i], radius_m);
            if (off_m && off_m->norm() > kCandidate * static_cast<double>(radius_m))
                found[i] = Border{i, radius_m, *off_m};
        }
    });
    for (const auto& border : found) {
        if (border) borders_.push_back(*border);
    }
    pairs_.resize(borders_.size());
}

const std::vector<Pair>& BorderPairs::at(const Pose& T, const std::vector<Pair>& surface) {
    in_pieces(borders_.size(), kAlignmentPiece, executor_, [&](auto begin, auto end, auto) {
        for (std::size_t i = begin; i < end; ++i)
            pairs_[i] = pair_up(borders_[i], T, surface[borders_[i].index]);
    });
    return pairs_;
}

Pair BorderPairs::pair_up(const Border& border, const Pose& T, const Pair& surface) const {
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
    pair.ball_m = radius_m;
    pair.across_m = moved_m.norm() - there_m;
    pair.sq_apart_m2 = pair.across_m * pair.across_m;
    pair.counts = true;
    return pair;
}

}  // namespace surefoot::geometry
