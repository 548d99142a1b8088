// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/map_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/report/percentile.hpp"
#include "surefoot/geometry/plane_fit.hpp"

namespace surefoot::eval {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Standard deviation divided by median absolute deviation, for a normal distribution.
constexpr double kSigmaPerMad = 1.4826;
constexpr double kOutlierSpreads = 3.0;
constexpr int kMostFits = 20;

bool in_mask(const CellMask& mask, int ix, int iy) {
    return mask.empty() || mask.at(ix, iy) != 0;
}

/// Returns the lower end of the height band of width kFloorBand_m that holds most of the heights.
double fullest_band(const std::vector<double>& sorted_m) {
    std::size_t best_count = 0;
    double best_low_m = kNone;
    std::size_t end = 0;
    for (std::size_t begin = 0; begin < sorted_m.size(); ++begin) {
        while (end < sorted_m.size() && sorted_m[end] <= sorted_m[begin] + kFloorBand_m) ++end;
        if (end - begin <= best_count) continue;
        best_count = end - begin;
        best_low_m = sorted_m[begin];
    }
    return best_low_m;
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return percentile_of_sorted(values, 0.5);
}

double spread_of(const std::vector<double>& residuals_m) {
    const double middle_m = median_of(residuals_m);
    std::vector<double> off_m;
    off_m.reserve(residuals_m.size());
    for (const double residual_m : residuals_m) off_m.push_back(std::abs(residual_m - middle_m));
    return kSigmaPerMad * median_of(std::move(off_m));
}

std::vector<double> residuals_of(const std::vector<Eigen::Vector3d>& points_m,
                                 const geometry::Plane& plane) {
    std::vector<double> residuals_m;
    residuals_m.reserve(points_m.size());
    for (const Eigen::Vector3d& p_m : points_m) residuals_m.push_back(plane.signed_distance_m(p_m));
    return residuals_m;
}

std::optional<geometry::Plane> robust_plane(const std::vector<Eigen::Vector3d>& points_m) {
    std::vector<int> kept(points_m.size());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = static_cast<int>(i);
    std::optional<geometry::Plane> plane;
    for (int fit = 0; fit < kMostFits; ++fit) {
        const auto fitted = geometry::fit_plane(points_m, kept);
        if (!fitted) return plane;
        plane = fitted->plane;
        const auto residuals_m = residuals_of(points_m, *plane);
        const double middle_m = median_of(residuals_m);
        const double limit_m = kOutlierSpreads * spread_of(residuals_m);
        std::vector<int> near;
        for (std::size_t i = 0; i < residuals_m.size(); ++i) {
            if (std::abs(residuals_m[i] - middle_m) <= limit_m) near.push_back(static_cast<int>(i));
        }
        if (near == kept) return plane;
        kept = std::move(near);
    }
    return plane;
}

}  // namespace

CellMask level_floor(const grid::Layer& truth_height_m, const EvalMapsConfig& config) {
    CellMask mask = away_from_edges(truth_height_m, config);
    std::vector<double> heights_m;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (mask.data()[i] != 0) heights_m.push_back(static_cast<double>(truth_height_m.data()[i]));
    }
    std::sort(heights_m.begin(), heights_m.end());
    const double low_m = fullest_band(heights_m);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const auto height_m = static_cast<double>(truth_height_m.data()[i]);
        const bool level = height_m >= low_m && height_m <= low_m + kFloorBand_m;
        if (!level) mask.data()[i] = 0;
    }
    return mask;
}

HeightJumps height_jumps(const grid::Layer& height_m,
                         const CellMask& mask,
                         const grid::Layer& key) {
    SUREFOOT_ASSERT(mask.empty() || mask.size() == height_m.size());
    SUREFOOT_ASSERT(key.empty() || key.size() == height_m.size());
    HeightJumps jumps;
    const auto add = [&](int ix, int iy, int jx, int jy) {
        if (!height_m.contains(jx, jy) || !in_mask(mask, ix, iy) || !in_mask(mask, jx, jy)) return;
        const float jump_m = height_m.at(jx, jy) - height_m.at(ix, iy);
        if (std::isnan(jump_m)) return;
        jumps.jump_m.push_back(jump_m);
        jumps.key.push_back(key.empty() ? std::numeric_limits<float>::quiet_NaN()
                                        : 0.5F * (key.at(ix, iy) + key.at(jx, jy)));
    };
    for (int iy = 0; iy < height_m.height(); ++iy) {
        for (int ix = 0; ix < height_m.width(); ++ix) {
            add(ix, iy, ix + 1, iy);
            add(ix, iy, ix, iy + 1);
        }
    }
    return jumps;
}

FloorSpread floor_spread(const grid::GridGeometry& geometry,
                         const grid::Layer& height_m,
                         const CellMask& mask) {
    SUREFOOT_ASSERT(height_m.width() == geometry.nx && height_m.height() == geometry.ny);
    std::vector<Eigen::Vector3d> points_m;
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const auto z_m = static_cast<double>(height_m.at(ix, iy));
            if (!std::isfinite(z_m) || !in_mask(mask, ix, iy)) continue;
            const Eigen::Vector2d center_m = geometry.center_m({ix, iy});
            points_m.emplace_back(center_m.x(), center_m.y(), z_m);
        }
    }
    const auto plane = robust_plane(points_m);
    if (!plane) return {kNone, kNone, kNone, kNone, 0};
    const auto residuals_m = residuals_of(points_m, *plane);
    std::vector<double> absolute_m;
    double sum_sq_m2 = 0.0;
    for (const double residual_m : residuals_m) {
        absolute_m.push_back(std::abs(residual_m));
        sum_sq_m2 += residual_m * residual_m;
    }
    std::sort(absolute_m.begin(), absolute_m.end());
    const double level = plane->normal.head<2>().norm();
    return {spread_of(residuals_m),
            std::sqrt(sum_sq_m2 / static_cast<double>(residuals_m.size())),
            percentile_of_sorted(absolute_m, 0.99),
            std::atan2(level, plane->normal.z()) * 180.0 / std::numbers::pi,
            static_cast<std::int64_t>(residuals_m.size())};
}

}  // namespace surefoot::eval
