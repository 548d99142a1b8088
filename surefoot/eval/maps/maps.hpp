// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

struct EvalMapsConfig {
    double safe_threshold = 0.80;  ///< a cell is safe when its traversability is at least this
    double edge_step_m = 0.03;     ///< a larger jump between true neighbours is an edge
    int edge_margin_cells = 2;     ///< cells within this distance of an edge are left out
    double large_error_m = 0.05;   ///< threshold of share_over_50mm
    void describe(ConfigVisitor& visitor);
};

/// Selected cells: 0 = no, any other value = yes. Same element order as grid::Layer.
using CellMask = Image<std::uint8_t>;

/// Reads `layer` of grid `from` at the cell centres of grid `to`. Takes the cell that contains the
/// centre; on a border, the cell with the greater index. NaN outside.
[[nodiscard]] grid::Layer resample_nearest(const grid::GridGeometry& from,
                                           const grid::Layer& layer,
                                           const grid::GridGeometry& to);

/// Cells with a known true height that are farther than the margin from every edge cell. Edge cells
/// are both sides of a jump between eight-neighbours; the distance is the larger of the two cell
/// differences. An unknown neighbour is not an edge.
[[nodiscard]] CellMask away_from_edges(const grid::Layer& truth_height_m,
                                       const EvalMapsConfig& config);

/// Cells whose centre is within `radius_m` of a point.
[[nodiscard]] CellMask within_radius(const grid::GridGeometry& geometry,
                                     const Eigen::Vector2d& center_m,
                                     double radius_m);

/// Cells that are set in both masks (of the same size).
[[nodiscard]] CellMask both(const CellMask& a, const CellMask& b);

/// Errors live - truth over the cells known in both maps [m]; all fields but count are NaN without
/// cells. Percentiles interpolate linearly between the two nearest ranks.
struct ElevationErrors {
    double median_abs_m = 0.0;
    double p90_abs_m = 0.0;
    double mean_m = 0.0;
    double rmse_m = 0.0;
    double share_over_50mm = 0.0;  ///< share of |error| > large_error_m, 0..1
    std::int64_t count = 0;
};

/// Live minus true height per cell; NaN if either is unknown.
[[nodiscard]] grid::Layer height_error(const grid::Layer& live_m, const grid::Layer& truth_m);

/// `mask` empty = all cells.
[[nodiscard]] ElevationErrors elevation_errors(const grid::Layer& live_m,
                                               const grid::Layer& truth_m,
                                               const CellMask& mask,
                                               const EvalMapsConfig& config);

/// Share of the cells with known truth (inside the mask) that live knows too; NaN if there is no
/// such cell.
[[nodiscard]] double coverage(const grid::Layer& live,
                              const grid::Layer& truth,
                              const CellMask& mask);

/// Result of a live map for one cell with known truth.
enum class Call : std::uint8_t {
    no_truth,
    unknown,  ///< unknown in the live map
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
    double unknown = 0.0;                 ///< share of all cells with a truth: unknown in live
    std::int64_t truly_safe_cells = 0;    ///< known in both
    std::int64_t truly_unsafe_cells = 0;  ///< known in both
    std::int64_t unknown_cells = 0;
};
/// `mask` empty = all cells.
[[nodiscard]] TraversabilityErrors traversability_errors(const Image<Call>& calls,
                                                         const CellMask& mask);

}  // namespace surefoot::eval
