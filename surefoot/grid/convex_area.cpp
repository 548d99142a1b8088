// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/convex_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::grid {
namespace {

/// Edges that rise less than this are skipped: neighbouring edges and corners cover them.
constexpr double kLevel_cells = 1e-9;
/// Largest gap between neighbouring pieces of the rim, from rounding (1e-10 at kMaxReach_cells) and
/// skipped level edges. It is far smaller than kSliver_cells.
constexpr double kSlack_cells = 1e-7;
static_assert(kSlack_cells > ConvexArea::kMaxPoints * kLevel_cells);

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Largest integer <= value. Without SSE4, std::floor would be a function call.
std::int64_t floor_of(double value) noexcept {
    // The constructor keeps every point within kMaxReach_cells, and a row of the area meets its
    // rim. in range: so a value is at most 2^21
    const auto truncated = static_cast<std::int64_t>(value);
    return truncated - (value < static_cast<double>(truncated) ? 1 : 0);
}

struct Cells {
    std::int64_t first = 0;
    std::int64_t end = 0;
};

/// Returns the cells that [low, high] overlaps by more than a sliver; at least one cell.
Cells cells_between(double low, double high) noexcept {
    const double middle = 0.5 * (low + high);
    return {floor_of(std::min(low + ConvexArea::kSliver_cells, middle)),
            floor_of(std::max(high - ConvexArea::kSliver_cells, middle)) + 1};
}

}  // namespace

ConvexArea::ConvexArea(std::span<const Eigen::Vector2d> points_m,
                       double radius_m,
                       const GridGeometry& geometry) noexcept {
    const auto count = static_cast<int>(points_m.size());
    if (count < 1 || count > kMaxPoints) return;
    if (!(geometry.resolution_m > 0.0) || !std::isfinite(geometry.resolution_m)) return;
    radius_ = radius_m / geometry.resolution_m;
    if (!(radius_ >= 0.0)) return;
    Points points;
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        points[k] = (points_m[k] - geometry.origin_m) / geometry.resolution_m;
        // The comparison with ! also rejects NaN.
        if (!(points[k].cwiseAbs().maxCoeff() + radius_ <= kMaxReach_cells)) return;
        if (!points[k].allFinite()) return;
    }
    take_hull(points, count);
    take_edges();
    take_rows();
}

void ConvexArea::take_hull(Points& points, int count) noexcept {
    // Andrew's monotone chain (1979): the lower half from left to right, the upper half back.
    const auto end = points.begin() + count;
    std::sort(points.begin(), end, [](const auto& a, const auto& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    Points chain;
    std::size_t size = 0;
    const auto extend = [&](const Eigen::Vector2d& point, std::size_t base) {
        while (size >= base + 2 && cross(chain[size - 2], chain[size - 1], point) <= 0.0) --size;
        chain[size++] = point;
    };
    for (int i = 0; i < count; ++i) extend(points[static_cast<std::size_t>(i)], 0);
    const std::size_t lower = size - 1;  // the last point starts the upper half
    for (int i = count - 2; i >= 0; --i) extend(points[static_cast<std::size_t>(i)], lower);
    hull_count_ = static_cast<int>(size > 1 ? size - 1 : size);  // the first point is also the last
    std::copy_n(chain.begin(), hull_count_, hull_.begin());
}

void ConvexArea::take_edges() noexcept {
    for (int i = 0; i < hull_count_; ++i) {
        const Eigen::Vector2d& a = hull_[static_cast<std::size_t>(i)];
        const Eigen::Vector2d& b = hull_[static_cast<std::size_t>((i + 1) % hull_count_)];
        const Eigen::Vector2d along = b - a;
        if (std::abs(along.y()) < kLevel_cells) continue;
        Eigen::Vector2d low = along.y() > 0.0 ? a : b;
        if (radius_ > 0.0) {
            const Eigen::Vector2d outward(along.y(), -along.x());
            low += outward * (radius_ / std::sqrt(along.squaredNorm()));
        }
        const Edge edge{low.y(), low.y() + std::abs(along.y()), low.x(), along.x() / along.y()};
        if (along.y() > 0.0) {
            right_[static_cast<std::size_t>(right_count_++)] = edge;
        } else {
            left_[static_cast<std::size_t>(left_count_++)] = edge;
        }
    }
}

void ConvexArea::take_rows() noexcept {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double leftmost = low;
    double rightmost = high;
    for (int i = 0; i < hull_count_; ++i) {
        const Eigen::Vector2d& point = hull_[static_cast<std::size_t>(i)];
        low = std::min(low, point.y() - radius_);
        high = std::max(high, point.y() + radius_);
        if (point.x() < leftmost) leftmost_y_ = point.y();
        if (point.x() > rightmost) rightmost_y_ = point.y();
        leftmost = std::min(leftmost, point.x());
        rightmost = std::max(rightmost, point.x());
    }
    const Cells rows = cells_between(low, high);
    first_row_ = rows.first;
    end_row_ = rows.end;
}

/// Returns the reach of the area at y, to the right (side = 1) or to the left (-1): the farthest
/// point at that y on an edge or on a circle around a corner.
double ConvexArea::rim_x(const Edge* edges, int count, double side, double y) const noexcept {
    double farthest = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < count; ++i) {
        const Edge& edge = edges[i];
        if (y < edge.low - kSlack_cells || y > edge.high + kSlack_cells) continue;
        const double dy = std::clamp(y, edge.low, edge.high) - edge.low;
        farthest = std::max(farthest, side * (edge.x_at_low + edge.x_per_y * dy));
    }
    // Without a radius the corners are ends of edges, so the edges suffice.
    const int corners = radius_ > 0.0 || count == 0 ? hull_count_ : 0;
    for (int i = 0; i < corners; ++i) {
        const Eigen::Vector2d& point = hull_[static_cast<std::size_t>(i)];
        const double dy = std::abs(y - point.y());
        if (dy > radius_ + kSlack_cells) continue;
        const double half_chord = std::sqrt(std::max(radius_ * radius_ - dy * dy, 0.0));
        farthest = std::max(farthest, side * point.x() + half_chord);
    }
    return side * farthest;
}

CellRun ConvexArea::row(std::int64_t iy) const noexcept {
    // The rim is convex. So within the row the rim reaches farthest at the y nearest to the extreme
    // point.
    const auto low = static_cast<double>(iy);
    const double left_y = std::clamp(leftmost_y_, low, low + 1.0);
    const double right_y = std::clamp(rightmost_y_, low, low + 1.0);
    const Cells cells = cells_between(rim_x(left_.data(), left_count_, -1.0, left_y),
                                      rim_x(right_.data(), right_count_, 1.0, right_y));
    return {iy, cells.first, cells.end};
}

}  // namespace surefoot::grid
