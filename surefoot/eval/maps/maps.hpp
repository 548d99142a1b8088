// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

struct EvalMapsConfig {
    double safe_threshold = 0.80;  ///< least traversability of a safe cell
    double edge_step_m = 0.03;     ///< a larger jump between true neighbouring heights is an edge
    int edge_margin_cells = 2;     ///< away_from_edges omits cells at most this far from an edge
    double large_error_m = 0.05;   ///< error limit of share_over_50mm
    void describe(ConfigVisitor& visitor);
};

/// Selected cells: 0 = not selected, any other value = selected. Element order as in grid::Layer.
using CellMask = Image<std::uint8_t>;

/// Reads `layer` of grid `from` at the cell centres of grid `to`. Takes the cell that contains the
/// centre; on a border, the cell with the greater index. Cells outside `from` are NaN.
[[nodiscard]] grid::Layer resample_nearest(const grid::GridGeometry& from,
                                           const grid::Layer& layer,
                                           const grid::GridGeometry& to);

/// Returns the cells with a known true height that are farther than the margin from every edge
/// cell. The cells on both sides of a jump between eight-neighbours are edge cells. The distance is
/// the larger of the two index differences. An unknown neighbour is not an edge.
[[nodiscard]] CellMask away_from_edges(const grid::Layer& truth_height_m,
                                       const EvalMapsConfig& config);

/// Returns the cells whose centre is within `radius_m` of a point.
[[nodiscard]] CellMask within_radius(const grid::GridGeometry& geometry,
                                     const Eigen::Vector2d& center_m,
                                     double radius_m);

/// Returns the cells that are set in both masks. Both masks must have the same size.
[[nodiscard]] CellMask both(const CellMask& a, const CellMask& b);

/// Errors (live minus truth) of the cells known in both maps [m]. All fields but count are NaN
/// without cells. Percentiles interpolate linearly between the two nearest ranks.
struct ElevationErrors {
    double median_abs_m = 0.0;
    double p90_abs_m = 0.0;
    double mean_m = 0.0;
    double rmse_m = 0.0;
    double share_over_50mm = 0.0;  ///< share of |error| > large_error_m, 0..1
    std::int64_t count = 0;
};

/// Returns live minus true height per cell; NaN if either height is unknown.
[[nodiscard]] grid::Layer height_error(const grid::Layer& live_m, const grid::Layer& truth_m);

/// Measures the cells in `mask`; an empty mask means all cells.
[[nodiscard]] ElevationErrors elevation_errors(const grid::Layer& live_m,
                                               const grid::Layer& truth_m,
                                               const CellMask& mask,
                                               const EvalMapsConfig& config);

/// Returns the share of the cells with known truth (inside the mask) that are also known in the
/// live map; NaN without such cells.
[[nodiscard]] double coverage(const grid::Layer& live,
                              const grid::Layer& truth,
                              const CellMask& mask);

/// Result of a live map for one cell, compared with the truth.
enum class Call : std::uint8_t {
    no_truth,
    unknown,  ///< the live map does not know the cell
    true_safe,
    true_unsafe,
    false_safe,    ///< an unsafe cell rated safe: the dangerous error
    false_unsafe,  ///< a safe cell rated unsafe: the hindering error
};
[[nodiscard]] Image<Call> classify(const grid::Layer& live_traversability,
                                   const grid::Layer& truth_traversability,
                                   double safe_threshold);

/// Shares of the cells known in both maps; NaN if the denominator is 0.
struct TraversabilityErrors {
    double false_safe = 0.0;              ///< share of the truly unsafe cells rated safe
    double false_unsafe = 0.0;            ///< share of the truly safe cells rated unsafe
    double true_safe = 0.0;               ///< share of the truly safe cells rated safe
    double true_unsafe = 0.0;             ///< share of the truly unsafe cells rated unsafe
    double unknown = 0.0;                 ///< unknown_cells / number of cells with known truth
    std::int64_t truly_safe_cells = 0;    ///< truly safe cells known in both maps
    std::int64_t truly_unsafe_cells = 0;  ///< truly unsafe cells known in both maps
    std::int64_t unknown_cells = 0;
};
/// Counts the cells in `mask`; an empty mask means all cells.
[[nodiscard]] TraversabilityErrors traversability_errors(const Image<Call>& calls,
                                                         const CellMask& mask);

}  // namespace surefoot::eval
