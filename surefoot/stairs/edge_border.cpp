// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edge_border.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kHuber_m = 0.012;  ///< half a cell
constexpr int kRounds = 6;

double median_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

double upper_tolerance_m(double scatter_m, double rise_m) {
    constexpr double kShare = 0.3;
    constexpr double kSigmas = 2.0;
    return std::clamp(kSigmas * scatter_m, kShare * rise_m, 0.6 * rise_m);
}

void add_border_points(const Terrain& terrain,
                       const EdgeLine& line,
                       const BorderSearch& search,
                       std::vector<BorderPoint>& out) {
    const grid::GridGeometry& grid = terrain.geometry;
    const Vector2d along = line.along();
    const Vector2d down = line.down();
    const int axis = std::abs(down.x()) >= std::abs(down.y()) ? 0 : 1;  // of the walk
    const int other = 1 - axis;
    const double length_m = line.length_m();
    const Vector2d from_m = line.from_m - search.beside_m * along + search.at_m * down;
    const Vector2d to_m = line.from_m + (length_m + search.beside_m) * along + search.at_m * down;
    const auto row_of = [&](double p_m) {
        return static_cast<int>(std::floor((p_m - grid.origin_m[other]) / grid.resolution_m));
    };
    const int rows = axis == 0 ? grid.ny : grid.nx;
    const int cells = axis == 0 ? grid.nx : grid.ny;
    const int first = std::max(0, row_of(std::min(from_m[other], to_m[other])));
    const int last = std::min(rows - 1, row_of(std::max(from_m[other], to_m[other])));
    const int way = down[axis] > 0.0 ? 1 : -1;
    const double least_m = search.upper_m - search.below_m;
    const auto height_at = [&](int cell, int row) {
        return static_cast<double>(axis == 0 ? terrain.height_m.row(row)[cell]
                                             : terrain.height_m.row(cell)[row]);
    };
    const auto is_upper = [&](int cell, int row) { return height_at(cell, row) >= least_m; };
    for (int row = first; row <= last; ++row) {
        const double at_row_m = grid.origin_m[other] + (row + 0.5) * grid.resolution_m;
        // Where the edge crosses the middle of the row, in cells.
        const double share = (at_row_m - from_m[other]) / (to_m[other] - from_m[other]);
        if (!(share >= 0.0 && share <= 1.0)) continue;
        const double cross_m = from_m[axis] + share * (to_m[axis] - from_m[axis]);
        const auto cell_of = [&](double s_m) {
            const double p_m = cross_m + s_m / down[axis];
            return static_cast<int>(std::floor((p_m - grid.origin_m[axis]) / grid.resolution_m));
        };
        int cell = cell_of(-search.inside_m);
        const int end = cell_of(search.outside_m);
        if (cell < 0 || cell >= cells || end < 0 || end >= cells) continue;
        // A bad cell inside is skipped; the ground has to begin before the edge.
        while (!is_upper(cell, row) && (end - cell) * way > 0 && cell != cell_of(0.0)) cell += way;
        if (!is_upper(cell, row)) continue;
        while (cell != end && is_upper(cell + way, row)) cell += way;
        if (cell == end) continue;  // no end: not this edge
        // Between the middles of the cells, as far as the next one is known.
        const double height_m = height_at(cell, row);
        const double next_m = height_at(cell + way, row);
        const double beyond = next_m < least_m ? (height_m - least_m) / (height_m - next_m) : 0.0;
        Vector2d border_m;
        border_m[axis] = grid.origin_m[axis] + (cell + 0.5 + way * beyond) * grid.resolution_m;
        border_m[other] = at_row_m;
        const Vector2d d_m = border_m - line.from_m;
        out.push_back({d_m.dot(down), d_m.dot(along), search.edge});
    }
}

double fit_parallel(std::span<const BorderPoint> points,
                    double middle_t_m,
                    std::span<ParallelEdge> edges) {
    std::vector<double> across_m;
    for (std::size_t k = 0; k < edges.size(); ++k) {
        across_m.clear();
        for (const BorderPoint& point : points)
            if (point.edge == static_cast<int>(k)) across_m.push_back(point.s_m);
        edges[k].points = static_cast<int>(across_m.size());
        if (!across_m.empty()) edges[k].at_m = median_of(across_m);
    }
    struct Sums {
        double w = 0.0, t = 0.0, s = 0.0, tt = 0.0, ts = 0.0, rr = 0.0;
    };
    std::vector<Sums> sums(edges.size());
    double turn_rad = 0.0;
    for (int round = 0; round < kRounds; ++round) {
        std::fill(sums.begin(), sums.end(), Sums{});
        for (const BorderPoint& point : points) {
            const auto k = static_cast<std::size_t>(point.edge);
            const double t_m = point.t_m - middle_t_m;
            const double residual_m = point.s_m - edges[k].at_m - turn_rad * t_m;
            const double w = std::min(1.0, kHuber_m / std::max(std::abs(residual_m), 1e-9));
            Sums& sum = sums[k];
            sum.w += w;
            sum.t += w * t_m;
            sum.s += w * point.s_m;
            sum.tt += w * t_m * t_m;
            sum.ts += w * t_m * point.s_m;
            sum.rr += w * residual_m * residual_m;
        }
        // The offsets are eliminated.
        double tt = 0.0, ts = 0.0;
        for (const Sums& sum : sums) {
            if (!(sum.w > 0.0)) continue;
            tt += sum.tt - sum.t * sum.t / sum.w;
            ts += sum.ts - sum.t * sum.s / sum.w;
        }
        if (!(tt > 0.0)) return 0.0;
        turn_rad = ts / tt;
        for (std::size_t k = 0; k < edges.size(); ++k) {
            if (!(sums[k].w > 0.0)) continue;
            edges[k].at_m = (sums[k].s - turn_rad * sums[k].t) / sums[k].w;
            edges[k].rms_m = std::sqrt(sums[k].rr / sums[k].w);
        }
    }
    return turn_rad;
}

}  // namespace surefoot::stairs
