// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_border.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kHuber_m = 0.012;  ///< limit of the Huber weights: half a cell
constexpr int kRounds = 6;

}  // namespace

double upper_tolerance_m(double scatter_m, double rise_m) {
    constexpr double kShare = 0.3;
    constexpr double kSigmas = 2.0;
    return std::clamp(kSigmas * scatter_m, kShare * rise_m, 0.6 * rise_m);
}

/// Walks the rows that cross an edge (the columns if the line runs along the rows).
class Rows {
  public:
    Rows(const Terrain& terrain, const EdgeLine& line, const BorderSearch& search)
        : grid_(terrain.geometry),
          line_(line),
          down_(line.down()),
          axis_(std::abs(down_.x()) >= std::abs(down_.y()) ? 0 : 1) {
        const Vector2d along = line.along();
        from_m_ = line.from_m - search.beside_m * along + search.at_m * down_;
        to_m_ = line.to_m + search.beside_m * along + search.at_m * down_;
        const int other = 1 - axis_;
        const auto row_of = [&](double p_m) {
            return grid::whole_cells(
                std::floor((p_m - grid_.origin_m[other]) / grid_.resolution_m));
        };
        first_ = std::max(0, row_of(std::min(from_m_[other], to_m_[other])));
        last_ = std::min(rows() - 1, row_of(std::max(from_m_[other], to_m_[other])));
    }
    [[nodiscard]] int first() const { return first_; }
    [[nodiscard]] int last() const { return last_; }
    /// Direction in which the cells of a row cross the edge: +1 or -1.
    [[nodiscard]] int way() const { return down_[axis_] > 0.0 ? 1 : -1; }
    /// Enters a row. Returns false if the row does not cross the edge between its ends, or if the
    /// search range leaves the map.
    bool enter(int row, double inside_m, double outside_m) {
        row_ = row;
        const int other = 1 - axis_;
        const double at_row_m = grid_.origin_m[other] + (row + 0.5) * grid_.resolution_m;
        const double share = (at_row_m - from_m_[other]) / (to_m_[other] - from_m_[other]);
        if (!(share >= 0.0 && share <= 1.0)) return false;
        cross_m_ = from_m_[axis_] + share * (to_m_[axis_] - from_m_[axis_]);
        begin_ = cell_of(-inside_m);
        end_ = cell_of(outside_m);
        const int cells = axis_ == 0 ? grid_.nx : grid_.ny;
        return begin_ >= 0 && begin_ < cells && end_ >= 0 && end_ < cells;
    }
    [[nodiscard]] int begin() const { return begin_; }
    [[nodiscard]] int end() const { return end_; }
    [[nodiscard]] int edge() const { return cell_of(0.0); }
    [[nodiscard]] double value(ImageView<const float> layer, int cell) const {
        return static_cast<double>(axis_ == 0 ? layer.row(row_)[cell] : layer.row(cell)[row_]);
    }
    [[nodiscard]] Vector2d middle_m(int cell) const {
        return axis_ == 0 ? grid_.center_m({cell, row_}) : grid_.center_m({row_, cell});
    }
    /// Converts a position in this row [cells from the centre of the first cell] to the frame of
    /// the line.
    [[nodiscard]] BorderPoint point(double cells, int edge) const {
        Vector2d p_m;
        p_m[axis_] = grid_.origin_m[axis_] + (cells + 0.5) * grid_.resolution_m;
        p_m[1 - axis_] = grid_.origin_m[1 - axis_] + (row_ + 0.5) * grid_.resolution_m;
        const Vector2d d_m = p_m - line_.from_m;
        return {d_m.dot(down_), d_m.dot(line_.along()), edge};
    }

  private:
    [[nodiscard]] int rows() const { return axis_ == 0 ? grid_.ny : grid_.nx; }
    /// The cell at distance `s_m` behind the edge, measured across the edge.
    [[nodiscard]] int cell_of(double s_m) const {
        const double p_m = cross_m_ + s_m / down_[axis_];
        return grid::whole_cells(std::floor((p_m - grid_.origin_m[axis_]) / grid_.resolution_m));
    }

    const grid::GridGeometry& grid_;
    const EdgeLine& line_;
    Vector2d down_;
    int axis_;  ///< axis of the walk
    Vector2d from_m_;
    Vector2d to_m_;
    int first_ = 0;
    int last_ = -1;
    int row_ = 0;
    double cross_m_ = 0.0;
    int begin_ = 0;
    int end_ = 0;
};

void add_border_points(const Terrain& terrain,
                       const EdgeLine& line,
                       const BorderSearch& search,
                       std::vector<BorderPoint>& out) {
    Rows rows(terrain, line, search);
    // If a cell holds the highest point of its area, the last upper centre lies on average beyond
    // an oblique edge, by less than half a cell. If a cell holds the height at its centre, the last
    // upper centre lies on average half a cell before the edge.
    const Vector2d down = line.down().cwiseAbs();
    const double reach_m =
        0.5 * terrain.geometry.resolution_m *
        (search.cell_reach * down.minCoeff() - (1.0 - search.cell_reach) * down.maxCoeff());
    const Vector2d middle_m = 0.5 * (line.from_m + line.to_m) + search.at_m * line.down();
    const double unmapped_m =
        terrain.view
            ? terrain.view->unmapped_m({middle_m.x(), middle_m.y(), search.upper_m}, line.down())
            : 0.0;
    const double least_m = search.upper_m - search.below_m;
    const auto is_upper = [&](int cell) { return rows.value(terrain.height_m, cell) >= least_m; };
    for (int row = rows.first(); row <= rows.last(); ++row) {
        if (!rows.enter(row, search.inside_m, search.outside_m)) continue;
        int cell = rows.begin();
        // Skips single bad cells inside, but the upper ground must begin before the edge.
        while (!is_upper(cell) && cell != rows.edge() && cell != rows.end()) cell += rows.way();
        if (!is_upper(cell)) continue;
        while (cell != rows.end() && is_upper(cell + rows.way())) cell += rows.way();
        if (cell == rows.end()) continue;  // the upper ground does not end in the search range
        // Interpolates between the cell centres if the next cell is known.
        const double height_m = rows.value(terrain.height_m, cell);
        const double next_m = rows.value(terrain.height_m, cell + rows.way());
        const double beyond = next_m < least_m ? (height_m - least_m) / (height_m - next_m) : 0.0;
        BorderPoint point = rows.point(cell + rows.way() * beyond, search.edge);
        point.s_m += next_m == next_m ? -reach_m : unmapped_m - reach_m;
        out.push_back(point);
    }
}

namespace {

void add_faces_near(const Terrain& terrain,
                    const EdgeLine& line,
                    const BorderSearch& search,
                    std::vector<BorderPoint>& out) {
    constexpr double kLevel = 1.2;  ///< density ratio of level ground, with a margin
    constexpr double kLeast = 1.5;  ///< smallest excess of a row, in points of a level cell
    Rows rows(terrain, line, search);
    // Weights must not depend on the position. Distant level ground near the camera height shows
    // fewer points, so `density_ratio` alone would pull the face towards distant ground.
    const auto level_px = [&](const Eigen::Vector2d& p_m, double z_m) {
        return terrain.view ? terrain.view->pixels_per_m2({p_m.x(), p_m.y(), z_m}) : 1.0;
    };
    const Vector2d middle_m = 0.5 * (line.from_m + line.to_m) + search.at_m * line.down();
    const double here_px = level_px(middle_m, search.upper_m);
    if (!(here_px > 0.0)) return;
    for (int row = rows.first(); row <= rows.last(); ++row) {
        if (!rows.enter(row, kFace_m, kFace_m)) continue;
        double sum = 0.0;
        double moment = 0.0;
        for (int cell = rows.begin();; cell += rows.way()) {
            const double excess = rows.value(terrain.density_ratio, cell) - kLevel;
            if (excess > 0.0) {
                const double points =
                    excess * level_px(rows.middle_m(cell), rows.value(terrain.height_m, cell)) /
                    here_px;
                sum += points;
                moment += points * cell;
            }
            if (cell == rows.end()) break;
        }
        if (sum >= kLeast) out.push_back(rows.point(moment / sum, search.edge));
    }
}

}  // namespace

void add_face_points(const Terrain& terrain,
                     const EdgeLine& line,
                     const BorderSearch& search,
                     std::vector<BorderPoint>& out) {
    if (terrain.density_ratio.empty()) return;
    // The border from heights alone lies before the face. So each round centres the window on the
    // face.
    BorderSearch centred = search;
    std::vector<BorderPoint> found;
    for (int round = 0; round < 3; ++round) {
        found.clear();
        add_faces_near(terrain, line, centred, found);
        if (found.size() < kLeastPoints) return;
        std::vector<double> across_m(found.size());
        std::transform(found.begin(), found.end(), across_m.begin(), [](const BorderPoint& point) {
            return point.s_m;
        });
        centred.at_m = upper_median_in_place(across_m);
    }
    out.insert(out.end(), found.begin(), found.end());
}

double across_sigma_m(const grid::GridGeometry& grid, const EdgeLine& line, double rms_m) {
    const double length_m = std::max(line.length_m(), grid.resolution_m);
    const double scatter_m = std::max(rms_m, 0.25 * grid.resolution_m) /
                             std::sqrt(std::max(1.0, length_m / kCorrelation_m));
    // If an edge runs along the grid, all rows see the edge at the same position within a cell.
    const Vector2d along = line.along().cwiseAbs();
    const double parts = std::max(1.0, length_m * along.minCoeff() / grid.resolution_m);
    return std::hypot(scatter_m, grid.resolution_m / std::sqrt(12.0 * parts));
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
        if (!across_m.empty()) edges[k].at_m = upper_median_in_place(across_m);
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
        // Eliminates the offsets of the edges.
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

Extent longest_run(
    std::span<const BorderPoint> points, int edge, double at_m, double near_m, double max_gap_m) {
    std::vector<double> along_m;
    for (const BorderPoint& point : points)
        if (point.edge == edge && std::abs(point.s_m - at_m) <= near_m)
            along_m.push_back(point.t_m);
    std::sort(along_m.begin(), along_m.end());
    Extent longest;
    for (std::size_t begin = 0; begin < along_m.size();) {
        std::size_t end = begin + 1;
        while (end < along_m.size() && along_m[end] - along_m[end - 1] <= max_gap_m) ++end;
        if (along_m[end - 1] - along_m[begin] > longest.to_m - longest.from_m)
            longest = {along_m[begin], along_m[end - 1]};
        begin = end;
    }
    return longest;
}

}  // namespace surefoot::stairs
