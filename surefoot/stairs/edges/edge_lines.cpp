// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr int kTouch_cells = 2;
/// Largest difference between the upper heights of touching points. It is larger than the noise of
/// one cell and smaller than the height between neighbouring steps.
constexpr float kLevel_m = 0.06F;
constexpr int kDraws = 60;
constexpr double kNear_m = 0.6;  ///< largest distance between two drawn points

Vector2d down_of(Side side) {
    switch (side) {
        case Side::plus_x: return {1.0, 0.0};
        case Side::minus_x: return {-1.0, 0.0};
        case Side::plus_y: return {0.0, 1.0};
        case Side::minus_y: return {0.0, -1.0};
    }
    return {1.0, 0.0};
}

Vector2d right_of(const Vector2d& along) {
    return {along.y(), -along.x()};
}

Vector2d place_of(const EdgePoint& point) {
    return point.at_m.cast<double>();
}

}  // namespace

void EdgeLineFinder::find(const grid::GridGeometry& grid,
                          std::span<const EdgePoint> points,
                          std::vector<EdgeLine>& out) {
    out.clear();
    pieces_.clear();
    resolution_m_ = grid.resolution_m;
    chain(grid, points);
    for (std::size_t begin = 0; begin < order_.size();) {
        std::size_t end = begin;
        while (end < order_.size() && parent_[static_cast<std::size_t>(order_[end])] ==
                                          parent_[static_cast<std::size_t>(order_[begin])])
            ++end;
        take_lines(points, std::span(order_).subspan(begin, end - begin));
        begin = end;
    }
    join(points);
    for (const Piece& piece : pieces_)
        if (piece.line.length_m() >= config_.min_length_m) out.push_back(piece.line);
    std::stable_sort(out.begin(), out.end(), [](const EdgeLine& a, const EdgeLine& b) {
        return a.length_m() > b.length_m();
    });
}

std::int32_t EdgeLineFinder::root_of(std::int32_t point) {
    while (parent_[static_cast<std::size_t>(point)] != point) {
        auto& parent = parent_[static_cast<std::size_t>(point)];
        parent = parent_[static_cast<std::size_t>(parent)];
        point = parent;
    }
    return point;
}

void EdgeLineFinder::chain(const grid::GridGeometry& grid, std::span<const EdgePoint> points) {
    first_.resize(grid.nx, grid.ny);
    first_.fill(-1);
    parent_.resize(points.size());
    std::iota(parent_.begin(), parent_.end(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const EdgePoint& point = points[i];
        for (int dy = -kTouch_cells; dy <= 0; ++dy) {
            for (int dx = -kTouch_cells; dx <= (dy < 0 ? kTouch_cells : 0); ++dx) {
                const int ix = point.ix + dx;
                const int iy = point.iy + dy;
                if (!first_.contains(ix, iy)) continue;
                for (std::int32_t k = first_.at(ix, iy); k >= 0 && k < static_cast<std::int32_t>(i);
                     ++k) {
                    const EdgePoint& other = points[static_cast<std::size_t>(k)];
                    if (other.ix != ix || other.iy != iy) break;
                    if (down_of(point.side).dot(down_of(other.side)) < -0.5) continue;
                    if (!(std::abs(point.upper_m - other.upper_m) <= kLevel_m)) continue;
                    const std::int32_t a = root_of(static_cast<std::int32_t>(i));
                    const std::int32_t b = root_of(k);
                    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
                }
            }
        }
        std::int32_t& first = first_.at(point.ix, point.iy);
        if (first < 0) first = static_cast<std::int32_t>(i);
    }
    for (std::size_t i = 0; i < points.size(); ++i) parent_[i] = root_of(static_cast<int>(i));
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
        return parent_[static_cast<std::size_t>(a)] < parent_[static_cast<std::size_t>(b)];
    });
}

void EdgeLineFinder::keep_longest_run(const Vector2d& at_m,
                                      const Vector2d& along,
                                      std::size_t least_points) {
    const auto at_x = static_cast<float>(at_m.x());
    const auto at_y = static_cast<float>(at_m.y());
    const auto along_x = static_cast<float>(along.x());
    const auto along_y = static_cast<float>(along.y());
    const auto tolerance_m = static_cast<float>(config_.fit_tolerance_m);
    run_.clear();
    for (const Left& left : left_) {
        const float x_m = left.x_m - at_x;
        const float y_m = left.y_m - at_y;
        if (std::abs(x_m * along_y - y_m * along_x) > tolerance_m) continue;
        // A point whose ground falls along the line belongs to another edge.
        if (left.down_x * along_y - left.down_y * along_x < 0.1F) continue;
        run_.push_back({x_m * along_x + y_m * along_y, left.point});
    }
    if (run_.size() < least_points) return run_.clear();  // too few points to beat the best line
    std::sort(run_.begin(), run_.end(), [](const Placed& a, const Placed& b) {
        return a.t_m < b.t_m || (a.t_m == b.t_m && a.point < b.point);
    });
    std::size_t best_begin = 0;
    std::size_t best_end = 0;
    float best_m = -1.0F;
    const auto gap_m = static_cast<float>(3.5 * resolution_m_);
    for (std::size_t begin = 0; begin < run_.size();) {
        std::size_t end = begin + 1;
        while (end < run_.size() && run_[end].t_m - run_[end - 1].t_m <= gap_m) ++end;
        const float length_m = run_[end - 1].t_m - run_[begin].t_m;
        if (length_m > best_m) {
            best_m = length_m;
            best_begin = begin;
            best_end = end;
        }
        begin = end;
    }
    if (run_.empty()) return;
    run_.erase(run_.begin() + static_cast<std::ptrdiff_t>(best_end), run_.end());
    run_.erase(run_.begin(), run_.begin() + static_cast<std::ptrdiff_t>(best_begin));
}

void EdgeLineFinder::take_lines(std::span<const EdgePoint> points,
                                std::span<const std::int32_t> chain) {
    // Pieces shorter than an edge may be joined later.
    const double least_m = 0.5 * config_.min_length_m;
    const auto least_points =
        saturated_integer<std::size_t>(std::max(3.0, 0.6 * least_m / resolution_m_));
    left_.clear();
    for (const std::int32_t i : chain) {
        const EdgePoint& point = points[static_cast<std::size_t>(i)];
        const Vector2d down = down_of(point.side);
        left_.push_back({point.at_m.x(),
                         point.at_m.y(),
                         static_cast<float>(down.x()),
                         static_cast<float>(down.y()),
                         i});
    }
    while (left_.size() >= least_points) {
        Rng rng(left_.size());
        double best_m = 0.0;
        Piece best;
        for (int draw = 0; draw < kDraws; ++draw) {
            const auto a = static_cast<std::size_t>(rng.below(left_.size()));
            const auto b = static_cast<std::size_t>(rng.below(left_.size()));
            const EdgePoint& first = points[static_cast<std::size_t>(left_[a].point)];
            const EdgePoint& second = points[static_cast<std::size_t>(left_[b].point)];
            Vector2d along = place_of(second) - place_of(first);
            const double apart_m = along.norm();
            if (apart_m < 0.4 * least_m || apart_m > kNear_m) continue;
            along /= apart_m;
            if (down_of(first.side).dot(right_of(along)) < 0.0) along = -along;
            // A longer line than the best line usually has at least two thirds of its points.
            keep_longest_run(
                place_of(first), along, std::max(least_points, best.members.size() * 2 / 3));
            if (run_.size() < least_points) continue;
            const auto length_m = static_cast<double>(run_.back().t_m - run_.front().t_m);
            if (length_m <= best_m) continue;
            best_m = length_m;
            best.members.clear();
            for (const Placed& placed : run_) best.members.push_back(placed.point);
            best.line.from_m = place_of(first) + static_cast<double>(run_.front().t_m) * along;
            best.line.to_m = place_of(first) + static_cast<double>(run_.back().t_m) * along;
        }
        if (best_m < least_m) return;
        for (int round = 0; round < 2; ++round) {
            if (!fit(points, best)) break;
            keep_longest_run(best.line.from_m, best.line.along(), least_points);
            if (run_.size() < least_points) break;
            best.members.clear();
            for (const Placed& placed : run_) best.members.push_back(placed.point);
        }
        const bool good = fit(points, best);
        // Also removes the points beside the line that the fit did not use. They belong to the same
        // edge.
        const Vector2d from_m = best.line.from_m;
        const Vector2d along = best.line.along();
        const double length_m = best.line.length_m();
        std::erase_if(left_, [&](const Left& left) {
            const Vector2d p_m = Vector2d(left.x_m, left.y_m) - from_m;
            return std::abs(p_m.dot(right_of(along))) <= 1.5 * config_.fit_tolerance_m &&
                   p_m.dot(along) >= -resolution_m_ && p_m.dot(along) <= length_m + resolution_m_;
        });
        if (good && best.line.length_m() >= least_m) pieces_.push_back(std::move(best));
    }
}

bool EdgeLineFinder::fit(std::span<const EdgePoint> points, Piece& piece) const {
    Vector2d mean_m = Vector2d::Zero();
    for (const std::int32_t i : piece.members)
        mean_m += place_of(points[static_cast<std::size_t>(i)]);
    const auto count = static_cast<double>(piece.members.size());
    if (count < 3.0) return false;
    mean_m /= count;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const std::int32_t i : piece.members) {
        const Vector2d d_m = place_of(points[static_cast<std::size_t>(i)]) - mean_m;
        xx += d_m.x() * d_m.x();
        xy += d_m.x() * d_m.y();
        yy += d_m.y() * d_m.y();
    }
    // Direction of the longer axis of the scatter of the points.
    const double angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
    Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    if (along.dot(piece.line.to_m - piece.line.from_m) < 0.0) along = -along;
    double least_t_m = 0.0, most_t_m = 0.0, square_m2 = 0.0;
    std::vector<double> upper_m;
    std::vector<double> lower_m;
    for (const std::int32_t i : piece.members) {
        const EdgePoint& point = points[static_cast<std::size_t>(i)];
        const Vector2d d_m = place_of(point) - mean_m;
        least_t_m = std::min(least_t_m, d_m.dot(along));
        most_t_m = std::max(most_t_m, d_m.dot(along));
        square_m2 += std::pow(d_m.dot(right_of(along)), 2);
        upper_m.push_back(static_cast<double>(point.upper_m));
        lower_m.push_back(static_cast<double>(point.lower_m));
    }
    piece.line.from_m = mean_m + least_t_m * along;
    piece.line.to_m = mean_m + most_t_m * along;
    piece.line.points = static_cast<int>(piece.members.size());
    piece.line.rms_m = std::sqrt(square_m2 / count);
    piece.upper_m = upper_median_in_place(upper_m);
    piece.lower_m = upper_median_in_place(lower_m);
    return most_t_m > least_t_m;
}

bool EdgeLineFinder::belong_together(const Piece& a, const Piece& b) const {
    constexpr double kLeastCosine = 0.985;  // 10 deg: a short piece's direction is uncertain
    if (a.line.along().dot(b.line.along()) < kLeastCosine) return false;
    constexpr auto kSame_m = static_cast<double>(kLevel_m);
    if (std::abs(a.upper_m - b.upper_m) > kSame_m || std::abs(a.lower_m - b.lower_m) > kSame_m)
        return false;
    const Piece& longer = a.line.length_m() >= b.line.length_m() ? a : b;
    const Piece& shorter = a.line.length_m() >= b.line.length_m() ? b : a;
    const Vector2d along = longer.line.along();
    const double length_m = longer.line.length_m();
    double before_m = 1e9, behind_m = -1e9;
    for (const Vector2d& end_m : {shorter.line.from_m, shorter.line.to_m}) {
        const Vector2d d_m = end_m - longer.line.from_m;
        if (std::abs(d_m.dot(right_of(along))) > 1.5 * config_.fit_tolerance_m) return false;
        before_m = std::min(before_m, d_m.dot(along));
        behind_m = std::max(behind_m, d_m.dot(along));
    }
    return before_m <= length_m + config_.max_gap_m && behind_m >= -config_.max_gap_m;
}

void EdgeLineFinder::join(std::span<const EdgePoint> points) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        for (std::size_t k = i + 1; k < pieces_.size();) {
            if (!belong_together(pieces_[i], pieces_[k])) {
                ++k;
                continue;
            }
            if (pieces_[k].line.length_m() > pieces_[i].line.length_m())
                std::swap(pieces_[i], pieces_[k]);
            auto& members = pieces_[i].members;
            members.insert(members.end(), pieces_[k].members.begin(), pieces_[k].members.end());
            (void)fit(points, pieces_[i]);
            pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(k));
            k = i + 1;  // the longer line may now reach other pieces
        }
    }
}

}  // namespace surefoot::stairs
