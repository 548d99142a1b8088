// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_relations.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::stairs {

using Eigen::Vector2d;

double overlap_m(const Edge& a, const Edge& b) {
    const Vector2d along = a.along();
    const double from_m = (b.from_m - a.from_m).dot(along);
    const double to_m = (b.to_m - a.from_m).dot(along);
    return std::min(a.length_m(), std::max(from_m, to_m)) - std::max(0.0, std::min(from_m, to_m));
}

bool same_ground(const Edge& a, const Edge& b) {
    constexpr double kSame_m = 0.04;
    return std::abs(a.upper_m - b.upper_m) <= kSame_m && std::abs(a.lower_m - b.lower_m) <= kSame_m;
}

bool is_parallel(const Edge& a, const Edge& b) {
    constexpr double kLeastCosine = 0.966;  // 15 deg
    return a.along().dot(b.along()) >= kLeastCosine;
}

bool is_part_of(const Edge& piece, const Edge& edge) {
    constexpr double kNear_m = 0.1;
    constexpr double kLeastCosine = 0.77;  // 40 deg
    if (piece.along().dot(edge.along()) < kLeastCosine) return false;
    const double near_m = (same_ground(piece, edge) ? 2.0 : 1.0) * kNear_m;
    if (std::abs(edge.below_m(piece.middle_m())) > near_m) return false;
    const double t_m = (piece.middle_m() - edge.from_m).dot(edge.along());
    return t_m >= -kNear_m && t_m <= edge.length_m() + kNear_m;
}

bool is_among(const Edge& edge, std::span<const Edge> chain) {
    constexpr double kBeyond_m = 0.3;
    constexpr double kLevel_m = 0.05;
    constexpr double kLeastCosine = 0.77;  // 40 deg
    const Edge& first = chain.front();
    const Edge& last = chain.back();
    const Vector2d middle_m = edge.middle_m();
    const double along_m = (middle_m - first.from_m).dot(first.along());
    return chain.size() > 1 && edge.along().dot(first.along()) >= kLeastCosine && along_m >= 0.0 &&
           along_m <= first.length_m() && first.below_m(middle_m) < 0.0 &&
           last.below_m(middle_m) > -kBeyond_m && edge.lower_m >= first.upper_m - kLevel_m &&
           edge.upper_m <= last.upper_m + kLevel_m;
}

bool goes_on(const Edge& edge, const Edge& piece, double max_gap_m) {
    constexpr double kLeastCosine = 0.996;  // 5 deg
    constexpr double kNear_m = 0.06;
    if (edge.along().dot(piece.along()) < kLeastCosine) return false;
    if (std::abs(edge.below_m(piece.from_m)) > kNear_m ||
        std::abs(edge.below_m(piece.to_m)) > kNear_m)
        return false;
    const double from_m = (piece.from_m - edge.from_m).dot(edge.along());
    const double to_m = (piece.to_m - edge.from_m).dot(edge.along());
    return from_m <= edge.length_m() + max_gap_m && to_m >= -max_gap_m;
}

Edge joined(Edge edge, const Edge& piece) {
    const double a_m = edge.length_m();
    const double b_m = piece.length_m();
    const Vector2d middle_m = (a_m * edge.middle_m() + b_m * piece.middle_m()) / (a_m + b_m);
    const Vector2d along = (a_m * edge.along() + b_m * piece.along()).normalized();
    double from_m = 0.0, to_m = 0.0;
    for (const Vector2d& end_m : {edge.from_m, edge.to_m, piece.from_m, piece.to_m}) {
        const double t_m = (end_m - middle_m).dot(along);
        from_m = std::min(from_m, t_m);
        to_m = std::max(to_m, t_m);
    }
    edge.from_m = middle_m + from_m * along;
    edge.to_m = middle_m + to_m * along;
    return edge;
}

}  // namespace surefoot::stairs
