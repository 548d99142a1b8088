// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/eval/report/percentile.hpp"

namespace surefoot::eval {
namespace {

constexpr double kNoShare = std::numeric_limits<double>::quiet_NaN();
/// A centre this close to a border [cells] counts as on the border. The limit is far below a cell
/// and far above the rounding errors of coordinates of some kilometres.
constexpr double kBorderCells = 1e-6;

template <typename T>
bool selected(const CellMask& mask, const Image<T>& layer, std::size_t element) {
    SUREFOOT_ASSERT(mask.empty() ||
                    (mask.width() == layer.width() && mask.height() == layer.height()));
    return mask.empty() || mask.data()[element] != 0;
}

double share(std::int64_t part, std::int64_t whole) {
    return whole == 0 ? kNoShare : static_cast<double>(part) / static_cast<double>(whole);
}

/// Returns the index in `from` of each of `count` cell centres along one axis; -1 outside.
std::vector<int> nearest_indices(double from_origin_m,
                                 double from_resolution_m,
                                 int from_count,
                                 double to_origin_m,
                                 double to_resolution_m,
                                 int count) {
    std::vector<int> indices(static_cast<std::size_t>(count), -1);
    for (int i = 0; i < count; ++i) {
        const double center_m = to_origin_m + to_resolution_m * (i + 0.5);
        const double index =
            std::floor((center_m - from_origin_m) / from_resolution_m + kBorderCells);
        if (index >= 0.0 && index < from_count) {
            indices[static_cast<std::size_t>(i)] = static_cast<int>(index);  // in range: as checked
        }
    }
    return indices;
}

bool is_edge(const grid::Layer& height_m, int ix, int iy, double step_m) {
    const auto center_m = static_cast<double>(height_m.at(ix, iy));
    for (int jy = iy - 1; jy <= iy + 1; ++jy) {
        for (int jx = ix - 1; jx <= ix + 1; ++jx) {
            if (!height_m.contains(jx, jy)) continue;
            // A comparison with an unknown height is false.
            if (std::abs(static_cast<double>(height_m.at(jx, jy)) - center_m) > step_m) return true;
        }
    }
    return false;
}

Call call_of(float live, float truth, double safe_threshold) {
    if (std::isnan(truth)) return Call::no_truth;
    if (std::isnan(live)) return Call::unknown;
    // The threshold is rounded to float like the layer, so a stored 0.80 is safe at a threshold of
    // 0.80.
    const auto threshold = static_cast<float>(safe_threshold);
    const bool is_safe = truth >= threshold;
    const bool called_safe = live >= threshold;
    if (is_safe) return called_safe ? Call::true_safe : Call::false_unsafe;
    return called_safe ? Call::false_safe : Call::true_unsafe;
}

}  // namespace

void EvalMapsConfig::describe(ConfigVisitor& visitor) {
    visitor.number("safe_threshold",
                   safe_threshold,
                   0.0,
                   1.0,
                   "smallest traversability (0 to 1) of a safe cell");
    visitor.number("edge_step_m",
                   edge_step_m,
                   0.0,
                   10.0,
                   "a larger difference between the true heights of neighbouring cells is an edge");
    visitor.integer("edge_margin_cells",
                    edge_margin_cells,
                    0,
                    100,
                    "margin around edges, in cells; results that use only cells away from edges, "
                    "for example elevation_away_from_edges, leave out cells within this margin");
    visitor.number(
        "large_error_m",
        large_error_m,
        0.0,
        10.0,
        "height error above which a cell counts as a large error (result share_over_50mm)");
}

grid::Layer resample_nearest(const grid::GridGeometry& from,
                             const grid::Layer& layer,
                             const grid::GridGeometry& to) {
    const auto columns = nearest_indices(
        from.origin_m.x(), from.resolution_m, from.nx, to.origin_m.x(), to.resolution_m, to.nx);
    const auto rows = nearest_indices(
        from.origin_m.y(), from.resolution_m, from.ny, to.origin_m.y(), to.resolution_m, to.ny);
    grid::Layer result(to.nx, to.ny, kNanF);
    for (int iy = 0; iy < to.ny; ++iy) {
        const int jy = rows[static_cast<std::size_t>(iy)];
        if (jy < 0) continue;
        for (int ix = 0; ix < to.nx; ++ix) {
            const int jx = columns[static_cast<std::size_t>(ix)];
            if (jx >= 0) result.at(ix, iy) = layer.at(jx, jy);
        }
    }
    return result;
}

CellMask away_from_edges(const grid::Layer& truth_height_m, const EvalMapsConfig& config) {
    const int nx = truth_height_m.width();
    const int ny = truth_height_m.height();
    CellMask mask(nx, ny, 0);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        mask.data()[i] = std::isnan(truth_height_m.data()[i]) ? 0 : 1;
    }
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            if (!is_edge(truth_height_m, ix, iy, config.edge_step_m)) continue;
            const int margin = config.edge_margin_cells;
            for (int jy = std::max(0, iy - margin); jy <= std::min(ny - 1, iy + margin); ++jy) {
                for (int jx = std::max(0, ix - margin); jx <= std::min(nx - 1, ix + margin); ++jx) {
                    mask.at(jx, jy) = 0;
                }
            }
        }
    }
    return mask;
}

CellMask within_radius(const grid::GridGeometry& geometry,
                       const Eigen::Vector2d& center_m,
                       double radius_m) {
    CellMask mask(geometry.nx, geometry.ny, 0);
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            const double distance_m = (geometry.center_m({ix, iy}) - center_m).norm();
            mask.at(ix, iy) = distance_m <= radius_m ? 1 : 0;
        }
    }
    return mask;
}

CellMask both(const CellMask& a, const CellMask& b) {
    SUREFOOT_ASSERT(a.width() == b.width() && a.height() == b.height());
    CellMask mask = a;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        mask.data()[i] = (a.data()[i] != 0 && b.data()[i] != 0) ? 1 : 0;
    }
    return mask;
}

grid::Layer height_error(const grid::Layer& live_m, const grid::Layer& truth_m) {
    SUREFOOT_ASSERT(live_m.width() == truth_m.width() && live_m.height() == truth_m.height());
    grid::Layer error_m(live_m.width(), live_m.height(), kNanF);
    for (std::size_t i = 0; i < error_m.size(); ++i) {
        error_m.data()[i] = live_m.data()[i] - truth_m.data()[i];  // NaN if either is NaN
    }
    return error_m;
}

ElevationErrors elevation_errors(const grid::Layer& live_m,
                                 const grid::Layer& truth_m,
                                 const CellMask& mask,
                                 const EvalMapsConfig& config) {
    const grid::Layer error_m = height_error(live_m, truth_m);
    std::vector<double> absolute_m;
    double sum_m = 0.0;
    double sum_sq_m2 = 0.0;
    std::int64_t large = 0;
    for (std::size_t i = 0; i < error_m.size(); ++i) {
        const auto error = static_cast<double>(error_m.data()[i]);
        if (std::isnan(error) || !selected(mask, error_m, i)) continue;
        absolute_m.push_back(std::abs(error));
        sum_m += error;
        sum_sq_m2 += error * error;
        if (std::abs(error) > config.large_error_m) ++large;
    }
    if (absolute_m.empty()) return {kNoShare, kNoShare, kNoShare, kNoShare, kNoShare, 0};
    std::sort(absolute_m.begin(), absolute_m.end());
    const auto count = static_cast<std::int64_t>(absolute_m.size());
    const auto n = static_cast<double>(count);
    return {percentile_of_sorted(absolute_m, 0.5),
            percentile_of_sorted(absolute_m, 0.9),
            sum_m / n,
            std::sqrt(sum_sq_m2 / n),
            share(large, count),
            count};
}

double coverage(const grid::Layer& live, const grid::Layer& truth, const CellMask& mask) {
    SUREFOOT_ASSERT(live.width() == truth.width() && live.height() == truth.height());
    std::int64_t all = 0;
    std::int64_t known = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (std::isnan(truth.data()[i]) || !selected(mask, truth, i)) continue;
        ++all;
        if (!std::isnan(live.data()[i])) ++known;
    }
    return share(known, all);
}

Image<Call> classify(const grid::Layer& live_traversability,
                     const grid::Layer& truth_traversability,
                     double safe_threshold) {
    SUREFOOT_ASSERT(live_traversability.size() == truth_traversability.size());
    Image<Call> calls(truth_traversability.width(), truth_traversability.height(), Call::no_truth);
    for (std::size_t i = 0; i < calls.size(); ++i) {
        calls.data()[i] =
            call_of(live_traversability.data()[i], truth_traversability.data()[i], safe_threshold);
    }
    return calls;
}

TraversabilityErrors traversability_errors(const Image<Call>& calls, const CellMask& mask) {
    std::int64_t counts[6] = {};
    for (std::size_t i = 0; i < calls.size(); ++i) {
        if (selected(mask, calls, i)) ++counts[static_cast<int>(calls.data()[i])];
    }
    const auto count = [&](Call call) { return counts[static_cast<int>(call)]; };
    TraversabilityErrors errors;
    errors.truly_safe_cells = count(Call::true_safe) + count(Call::false_unsafe);
    errors.truly_unsafe_cells = count(Call::true_unsafe) + count(Call::false_safe);
    errors.unknown_cells = count(Call::unknown);
    errors.false_safe = share(count(Call::false_safe), errors.truly_unsafe_cells);
    errors.true_unsafe = share(count(Call::true_unsafe), errors.truly_unsafe_cells);
    errors.false_unsafe = share(count(Call::false_unsafe), errors.truly_safe_cells);
    errors.true_safe = share(count(Call::true_safe), errors.truly_safe_cells);
    errors.unknown =
        share(errors.unknown_cells,
              errors.unknown_cells + errors.truly_safe_cells + errors.truly_unsafe_cells);
    return errors;
}

}  // namespace surefoot::eval
