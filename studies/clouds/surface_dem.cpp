// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/surface_dem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::app {
namespace {

/// Largest number of points of a band in memory. A point takes 8 bytes, plus 4 bytes in the copy
/// that is sorted by cell.
constexpr std::int64_t kMostPoints = 1 << 25;

struct CellPoint {
    std::uint32_t cell;
    float z_m;
};

/// Rows [begin, end) that are processed together. The neighbouring rows supply witnesses: points
/// that support a height in a cell with few points.
struct Band {
    int begin = 0;
    int end = 0;
};

std::vector<Band> bands_of(const std::vector<std::int64_t>& points_of_row) {
    std::vector<Band> bands;
    std::int64_t points = 0;
    for (int row = 0; row < static_cast<int>(points_of_row.size()); ++row) {
        points += points_of_row[static_cast<std::size_t>(row)];
        if (bands.empty() || points > kMostPoints) {
            bands.push_back({row, row});
            points = points_of_row[static_cast<std::size_t>(row)];
        }
        bands.back().end = row + 1;
    }
    return bands;
}

/// The heights of each cell in ascending order.
class CellHeights {
  public:
    CellHeights(const std::vector<CellPoint>& points, std::uint32_t first, std::size_t cells)
        : first_(first), begin_(cells + 1, 0), z_m_(points.size()) {
        for (const CellPoint& p : points) ++begin_[p.cell - first_ + 1];
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for (const CellPoint& p : points) z_m_[next[p.cell - first_]++] = p.z_m;
        for (std::size_t i = 0; i < cells; ++i) std::sort(at(begin_[i]), at(begin_[i + 1]));
    }
    [[nodiscard]] std::span<const float> of(std::uint32_t cell) const {
        if (cell < first_ || cell - first_ + 1 >= begin_.size()) return {};
        const std::size_t i = cell - first_;
        return std::span(z_m_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
    }

  private:
    std::vector<float>::iterator at(std::size_t i) {
        return z_m_.begin() + static_cast<std::ptrdiff_t>(i);
    }
    std::uint32_t first_;
    std::vector<std::size_t> begin_;
    std::vector<float> z_m_;
};

struct CellGround {
    float z_m = kNanF;
    float points = 0.0F;  ///< points of the group that contains the ground
    float clearance_m = kNanF;
};

class CellReducer {
  public:
    CellReducer(const SurfaceRules& rules, const grid::GridGeometry& geometry)
        : rules_(rules),
          geometry_(geometry),
          half_width_m_(elevation::half_width(
              rules.reduction, static_cast<float>(rules.point_sigma_m * rules.point_sigma_m))) {}

    [[nodiscard]] CellGround ground(const CellHeights& heights, int ix, int iy) const {
        const std::span<const float> z_m = heights.of(number(ix, iy));
        CellGround ground;
        if (z_m.empty()) return ground;
        // Every group needs the same number of points, which follows from the number of points in
        // the whole cell.
        const int wanted = elevation::support_of(rules_.reduction, static_cast<int>(z_m.size()));
        for (std::size_t begin = 0, end = 0; begin < z_m.size(); begin = end) {
            end = end_of_group(z_m, begin);
            const auto group = z_m.subspan(begin, end - begin);
            if (std::isnan(ground.z_m)) {
                // A mirror image lies below a surface, so other points lie above it. It also has
                // fewer points than a surface.
                const int twice =
                    end < z_m.size() ? std::max(wanted, 2 * rules_.reduction.min_points) : wanted;
                ground.z_m = surface_m(heights, group, twice, ix, iy);
                ground.points = static_cast<float>(group.size());
            } else if (static_cast<int>(group.size()) >=
                       wanted) {  // this group overhangs, even if it has no surface
                ground.clearance_m = group.front() - ground.z_m;
                return ground;
            }
        }
        return ground;
    }

  private:
    [[nodiscard]] std::size_t end_of_group(std::span<const float> z_m, std::size_t begin) const {
        std::size_t end = begin + 1;
        while (end < z_m.size() &&
               static_cast<double>(z_m[end] - z_m[end - 1]) < rules_.min_overhead_m)
            ++end;
        return end;
    }
    [[nodiscard]] std::uint32_t number(int ix, int iy) const {
        return static_cast<std::uint32_t>(iy) * static_cast<std::uint32_t>(geometry_.nx) +
               static_cast<std::uint32_t>(ix);
    }
    /// Returns the highest surface of a group; NaN if there is none.
    [[nodiscard]] float surface_m(const CellHeights& heights,
                                  std::span<const float> group,
                                  int wanted,
                                  int ix,
                                  int iy) const {
        if (static_cast<int>(group.size()) < wanted) {
            // The cloud is sparse if the whole cell has fewer points than a surface needs.
            const bool sparse =
                static_cast<int>(heights.of(number(ix, iy)).size()) < rules_.reduction.min_points;
            return sparse ? witnessed_m(heights, group, wanted, ix, iy) : kNanF;
        }
        return dense_surface_m(group, wanted);
    }
    /// Returns the highest surface that enough points share and that is denser than a uniform
    /// scatter over the height of the group. Points in flight fill this height evenly. A surface
    /// with more than a third of the points above it is not the ground. Without ground, a cell with
    /// many points is a vertical face; otherwise it is unknown.
    [[nodiscard]] float dense_surface_m(std::span<const float> group, int wanted) const {
        constexpr float kDenser = 2.5F;
        elevation::ReductionConfig config = rules_.reduction;
        config.min_points = wanted;
        config.min_face_points = std::numeric_limits<int>::max();
        const auto n = static_cast<int>(group.size());
        const float window_m = 2.0F * half_width_m_;
        const float height_m = std::max(group.back() - group.front(), window_m);
        const float variance_m2 = static_cast<float>(rules_.point_sigma_m * rules_.point_sigma_m);
        for (std::span<const float> rest = group; n - static_cast<int>(rest.size()) <= n / 3;) {
            const std::vector<float> var_m2(rest.size(), variance_m2);
            const auto found = elevation::reduce_cell(config, rest, var_m2);
            if (!found) break;
            if (height_m <= 2.0F * window_m) return found->z_m;
            // Number of the other points that a uniform scatter would put into a window of equal
            // height.
            const float scattered =
                static_cast<float>(n - found->points) * window_m / (height_m - window_m);
            if (static_cast<float>(found->points) >= kDenser * scattered) return found->z_m;
            const auto end = std::lower_bound(rest.begin(), rest.end(), found->z_m - half_width_m_);
            rest = rest.first(static_cast<std::size_t>(end - rest.begin()));
        }
        if (n < rules_.reduction.min_face_points) return kNanF;
        return group[group.size() - static_cast<std::size_t>(wanted)];
    }
    /// Returns the highest point with enough witnesses in the surrounding cells; NaN = none. The
    /// height of a witness differs by at most the window plus the rise of a 45 deg slope over one
    /// cell.
    [[nodiscard]] float witnessed_m(const CellHeights& heights,
                                    std::span<const float> group,
                                    int wanted,
                                    int ix,
                                    int iy) const {
        const float reach_m = half_width_m_ + static_cast<float>(geometry_.resolution_m);
        for (auto z = group.rbegin(); z != group.rend(); ++z) {
            int witnesses = 0;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (ix + dx < 0 || ix + dx >= geometry_.nx || iy + dy < 0) continue;
                    for (const float other_m : heights.of(number(ix + dx, iy + dy)))
                        witnesses += std::abs(other_m - *z) <= reach_m ? 1 : 0;
                }
            }
            if (witnesses >= wanted) return *z;
        }
        return kNanF;
    }

    const SurfaceRules& rules_;
    const grid::GridGeometry& geometry_;
    float half_width_m_;
};

/// Removes ground with far fewer points than its surroundings: less than 1/5 of the upper quartile
/// of 5 x 5 cells. For example, the occluded area behind a nosing contains only a few points in
/// flight from the nosing.
void remove_thin(const grid::Layer& points, SurfaceDem& dem) {
    constexpr int kReach = 2;
    constexpr float kShare = 0.2F;
    const int nx = points.width();
    const int ny = points.height();
    std::vector<float> around;
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            if (std::isnan(dem.height_m.at(ix, iy))) continue;
            around.clear();
            for (int y = std::max(iy - kReach, 0); y <= std::min(iy + kReach, ny - 1); ++y) {
                for (int x = std::max(ix - kReach, 0); x <= std::min(ix + kReach, nx - 1); ++x)
                    if (points.at(x, y) > 0.0F) around.push_back(points.at(x, y));
            }
            const auto quartile =
                around.begin() + static_cast<std::ptrdiff_t>(around.size() * 3 / 4);
            std::nth_element(around.begin(), quartile, around.end());
            if (points.at(ix, iy) >= kShare * *quartile) continue;
            dem.height_m.at(ix, iy) = kNanF;
            dem.clearance_m.at(ix, iy) = kNanF;
        }
    }
}

}  // namespace

Result<SurfaceDem> surface_dem(const eval::DemGrid& grid,
                               const SurfaceRules& rules,
                               const EachBlock& each_block,
                               Executor& executor) {
    const grid::GridGeometry& geometry = grid.geometry;
    const auto nx = static_cast<std::uint32_t>(geometry.nx);
    SurfaceDem dem;
    dem.height_m = grid::Layer(geometry.nx, geometry.ny, kNanF);
    dem.clearance_m = grid::Layer(geometry.nx, geometry.ny, kNanF);
    const auto is_kept = [&](const Eigen::Vector3d& p_m) {
        return p_m.z() >= rules.lowest_z_m && p_m.z() <= rules.highest_z_m;
    };
    std::vector<std::int64_t> points_of_row(static_cast<std::size_t>(geometry.ny), 0);
    const auto counted = each_block([&](std::span<const Eigen::Vector3d> points_m) {
        for (const Eigen::Vector3d& p_m : points_m) {
            const std::uint32_t cell = eval::cell_number(grid, p_m);
            if (cell == eval::kNoCell) continue;
            if (is_kept(p_m)) {
                ++points_of_row[cell / nx];
            } else {
                ++dem.cut_points;
            }
        }
        return Status();
    });
    if (!counted) return counted.error();
    const CellReducer reducer(rules, geometry);
    grid::Layer points_of(geometry.nx, geometry.ny, 0.0F);  // ground points of each cell
    grid::Layer held(geometry.nx, geometry.ny, 0.0F);
    for (const Band& band : bands_of(points_of_row)) {
        // The witnesses need one more row on both sides.
        const std::uint32_t first = static_cast<std::uint32_t>(std::max(band.begin - 1, 0)) * nx;
        const std::uint32_t last =
            static_cast<std::uint32_t>(std::min(band.end + 1, geometry.ny)) * nx;
        std::vector<CellPoint> points;
        const auto read = each_block([&](std::span<const Eigen::Vector3d> points_m) {
            for (const Eigen::Vector3d& p_m : points_m) {
                const std::uint32_t cell = eval::cell_number(grid, p_m);
                if (cell >= first && cell < last && is_kept(p_m))
                    points.push_back({cell, static_cast<float>(p_m.z())});
            }
            return Status();
        });
        if (!read) return read.error();
        const CellHeights heights(points, first, last - first);
        executor.parallel_for(band.end - band.begin, [&](int i) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                const CellGround ground = reducer.ground(heights, ix, band.begin + i);
                dem.height_m.at(ix, band.begin + i) = ground.z_m;
                if (!std::isnan(ground.z_m)) points_of.at(ix, band.begin + i) = ground.points;
                held.at(ix, band.begin + i) =
                    heights.of(static_cast<std::uint32_t>(band.begin + i) * nx +
                               static_cast<std::uint32_t>(ix))
                            .empty()
                        ? 0.0F
                        : 1.0F;
                dem.clearance_m.at(ix, band.begin + i) = ground.clearance_m;
            }
        });
    }
    remove_thin(points_of, dem);
    for (std::size_t i = 0; i < dem.height_m.size(); ++i) {
        dem.unsupported_cells +=
            held.data()[i] > 0.0F && std::isnan(dem.height_m.data()[i]) ? 1 : 0;
        dem.overhung_cells += std::isnan(dem.clearance_m.data()[i]) ? 0 : 1;
    }
    return dem;
}

Result<SurfaceRules> surface_rules(std::optional<double> lowest_z_m,
                                   std::optional<double> highest_z_m) {
    SurfaceRules rules;
    if (lowest_z_m) rules.lowest_z_m = *lowest_z_m;
    if (highest_z_m) rules.highest_z_m = *highest_z_m;
    if (rules.lowest_z_m < rules.highest_z_m) return rules;
    return usage_error(fmt::format(
        "--min-height {:g} must be below --max-height {:g}", rules.lowest_z_m, rules.highest_z_m));
}

std::string left_out_text(const SurfaceDem& dem) {
    std::string text;
    const auto add = [&](std::int64_t count, const char* what) {
        if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count, what);
    };
    add(dem.cut_points, "points outside --min-height and --max-height are left out");
    add(dem.unsupported_cells, "cells are unknown: they contain points but no supported surface");
    add(dem.overhung_cells, "cells have an object that hangs over their ground");
    return text;
}

}  // namespace surefoot::app
