// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::stairs {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Smallest height of an edge point in sigma. It is lower than that of an edge, because the
/// finished edge is tested again.
constexpr double kPointSigmas = 1.5;
/// Longest occluded region: shadow_per_height for a drop of 1 m.
constexpr double kLongestShadow_m = 2.5;

bool known(float value) {
    return value == value;
}

}  // namespace

void EdgePointFinder::find(const Terrain& terrain, std::vector<EdgePoint>& out) {
    out.clear();
    const grid::GridGeometry& grid = terrain.geometry;
    resolution_m_ = grid.resolution_m;
    const auto cells_in = [&](double length_m) {
        return std::max(2, grid::whole_cells(std::ceil(length_m / resolution_m_ - 1e-6)));
    };
    window_cells_ = cells_in(config_.smear_m);
    reach_cells_ = cells_in(kLongestShadow_m);

    for (const Side side : {Side::plus_x, Side::minus_x, Side::plus_y, Side::minus_y}) {
        const bool along_x = side == Side::plus_x || side == Side::minus_x;
        const bool reversed = side == Side::minus_x || side == Side::minus_y;
        const int lines = along_x ? grid.ny : grid.nx;
        const int cells = along_x ? grid.nx : grid.ny;
        for (int line = 0; line < lines; ++line) {
            take_line(terrain, side, line);
            for (const Found& found : found_) {
                const int cell = reversed ? cells - 1 - found.cell : found.cell;
                EdgePoint point;
                point.ix = static_cast<std::int16_t>(along_x ? cell : line);
                point.iy = static_cast<std::int16_t>(along_x ? line : cell);
                point.side = side;
                point.upper_m = found.upper_m;
                point.lower_m = found.lower_m;
                point.lower_seen = found.lower_seen;
                const double step_m = (reversed ? -0.5 : 0.5) * resolution_m_;
                const Eigen::Vector2d border_m =
                    grid.center_m({point.ix, point.iy}) +
                    (along_x ? Eigen::Vector2d(step_m, 0.0) : Eigen::Vector2d(0.0, step_m));
                point.at_m = border_m.cast<float>();
                if (found.ends) {
                    const double behind_m = (reversed ? -1.0 : 1.0) * config_.smear_m;
                    const Eigen::Vector2d p_m =
                        border_m +
                        (along_x ? Eigen::Vector2d(behind_m, 0.0) : Eigen::Vector2d(0.0, behind_m));
                    if (!terrain.view ||
                        !terrain.view->shows(
                            {p_m.x(), p_m.y(), static_cast<double>(found.upper_m)}))
                        continue;
                }
                out.push_back(point);
            }
        }
    }
    std::sort(out.begin(), out.end(), [](const EdgePoint& a, const EdgePoint& b) {
        if (a.iy != b.iy) return a.iy < b.iy;
        if (a.ix != b.ix) return a.ix < b.ix;
        return a.side < b.side;
    });
}

void EdgePointFinder::take_line(const Terrain& terrain, Side side, int index) {
    const bool along_x = side == Side::plus_x || side == Side::minus_x;
    const bool reversed = side == Side::minus_x || side == Side::minus_y;
    const int cells = along_x ? terrain.geometry.nx : terrain.geometry.ny;
    const auto line_of = [&](ImageView<const float> layer) {
        if (layer.empty()) return Strided{};
        const std::ptrdiff_t step = along_x ? 1 : layer.stride;
        const float* first = along_x ? layer.row(index) : layer.data + index;
        return reversed ? Strided{first + (cells - 1) * step, -step} : Strided{first, step};
    };
    const Strided height_m = line_of(terrain.height_m);
    height_m_.resize(static_cast<std::size_t>(cells));
    const float* from = height_m.first;
    for (float& cell_m : height_m_) {
        cell_m = *from;
        from += height_m.step;
    }
    found_.clear();
    scan({cells, height_m_.data(), line_of(terrain.height_var_m2), line_of(terrain.free_above_m)});
}

void EdgePointFinder::scan(const Line& line) {
    // Most ground does not fall. One pass finds the lowest cell ahead and excludes most cells.
    const auto cells = static_cast<std::size_t>(line.cells);
    low_m_.assign(cells, kNothing);
    for (std::size_t ahead = 1; ahead <= static_cast<std::size_t>(window_cells_); ++ahead) {
        const float* next_m = line.height_m + ahead;
        float* low_m = low_m_.data();
        for (std::size_t i = 0; i + ahead < cells; ++i)
            low_m[i] = next_m[i] < low_m[i] ? next_m[i] : low_m[i];
    }
    const auto least_m = static_cast<float>(config_.min_height_m);
    Found found;
    for (int i = 0; i + 1 < line.cells; ++i) {
        if (!known(line.height_m[i])) continue;
        const bool falls = low_m_[static_cast<std::size_t>(i)] < line.height_m[i] - 0.4F * least_m;
        if ((falls || !known(line.height_m[i + 1])) && falls_at(line, i, found)) {
            found.cell = i;
            found_.push_back(found);
        }
    }
}

bool EdgePointFinder::falls_at(const Line& line, int cell, Found& found) const {
    int top = cell;
    for (int k = 1; k <= window_cells_ && cell - k >= 0 && known(line.height_m[cell - k]); ++k)
        if (line.height_m[cell - k] > line.height_m[top]) top = cell - k;
    const float top_m = line.height_m[top];

    int low = -1;
    float bound_m = kNothing;
    int k = 1;
    for (; k <= window_cells_ && cell + k < line.cells; ++k) {
        const float next_m = line.height_m[cell + k];
        if (!known(next_m)) break;
        if (low < 0 || next_m < line.height_m[low]) low = cell + k;
    }
    // If the known ground ends within the window, finds the next known cell behind the occluded
    // region.
    if (k <= window_cells_) {
        for (; k <= reach_cells_ && cell + k < line.cells; ++k) {
            const int behind = cell + k;
            if (known(line.height_m[behind])) {
                const auto height_m = static_cast<double>(top_m - line.height_m[behind]);
                const double longest_m =
                    config_.shadow_per_height * height_m + config_.smear_m + resolution_m_;
                if (k * resolution_m_ <= longest_m &&
                    (low < 0 || line.height_m[behind] < line.height_m[low]))
                    low = behind;
                break;
            }
            if (k <= window_cells_) {
                const float free_m = line.free_above_m.at(behind, kNothing);
                bound_m = free_m < bound_m ? free_m : bound_m;
            }
        }
    }
    found.lower_seen = low >= 0 && line.height_m[low] <= bound_m;
    found.lower_m = found.lower_seen ? line.height_m[low] : bound_m;
    found.upper_m = top_m;
    found.ends = low < 0 && !(bound_m < top_m);
    if (found.ends) {
        // Ground ends only if the next window is unknown from its first cell on.
        if (k <= window_cells_ || cell - window_cells_ < 0) return false;
        found.lower_m = top_m - static_cast<float>(config_.max_riser_m);  // assumed, not seen
        return true;
    }
    const auto height_m = static_cast<double>(top_m - found.lower_m);
    const float var_m2 =
        line.var_m2.at(top, 0.0F) + (found.lower_seen ? line.var_m2.at(low, 0.0F) : 0.0F);
    const double least_m =
        std::max(config_.min_height_m, kPointSigmas * std::sqrt(static_cast<double>(var_m2)));
    if (!(height_m >= least_m)) return false;
    const float middle_m = 0.5F * (top_m + found.lower_m);
    const float next_m = line.height_m[cell + 1];
    return line.height_m[cell] >= middle_m && (!known(next_m) || next_m < middle_m);
}

}  // namespace surefoot::stairs
