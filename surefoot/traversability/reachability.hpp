// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Cells on which the machine is assumed to stand.
struct Stance {
    int cells = 0;          ///< number of start cells; 0 if the map has no known cell
    double lowest_m = 0.0;  ///< lowest height of these cells in the map frame; 0 without cells
    double radius_m = 0.0;  ///< search radius around the body
};

/// Finds the ground that the machine can reach on foot from its stance, and over which steps: a
/// table top is flat but not reachable.
///
/// reach_step_m of a cell: each way from the stance to the cell has a largest height difference
/// between consecutive cells. reach_step_m is the smallest of these over all ways (minimax path). A
/// way leads from known cell to known 4-neighbour. It never crosses an unknown cell or a gap, not
/// even of one cell. Up and down count alike: the smallest step up and the smallest step down may
/// lie on different ways. So a layer for each would promise a way that does not exist. Heights are
/// rounded to 0.1 mm as for the gate. For these heights the result is exact. It does not depend on
/// the order of the visits.
///
/// NaN = unknown, or not reachable, or reachable only over a step above `max_step_m`; only unknown
/// cells have no height. Every comparison with NaN is false, so `<= limit` never accepts NaN as
/// reachable. A ramp has no steps: the slope tells how steep a way is. The map may smear an edge:
/// then cells lie at heights between the two levels, and the riser counts only by its parts, which
/// are lower than the whole riser.
///
/// Stance: the known cells with their centre within `stance_radius_m` of the body along the ground.
/// If they are fewer than kStanceCells (ground at the feet not in view), the radius is larger: the
/// distance within which so many cells (or all) are known, plus `stance_radius_m`. The lowest
/// surface counts, because a table top may hang over the feet. It is the lowest range of
/// heights, kSurface_m high, with a quarter of these cells. So neither a stray low cell nor a pit
/// becomes the stance. If no such range exists, the range with most cells counts. The height of the
/// body is not used, because base_link may be anywhere above the ground.
///
/// Cost: four reads per known cell, plus one visit per 0.1 mm of `max_step_m` (Dijkstra 1959 with
/// one bucket per length, Dial 1969). Allocates only to grow. Not thread-safe.
class Reachability {
  public:
    static constexpr int kStanceCells = 16;     ///< smallest number of cells; 0.01 m2 at 25 mm
    static constexpr double kSurface_m = 0.05;  ///< height range of one surface under the body
    /// Heights beyond this are unknown, as for the gate.
    static constexpr double kHighest_m = 1000.0;

    explicit Reachability(const TraversabilityConfig::Reach& config);

    /// `height_m`: one row per iy of `geometry`, NaN = unknown. `body_m`: in the frame of the map.
    /// `reach_step_m` takes the size of the map.
    Stance reach(const grid::GridGeometry& geometry,
                 ImageView<const float> height_m,
                 const Eigen::Vector2d& body_m,
                 grid::Layer& reach_step_m);

  private:
    /// Entry of a bucket: a cell that a step reaches, and the next entry of the same bucket.
    struct Waiting {
        std::int32_t cell;
        std::int32_t next;
    };
    struct Cell {
        std::int32_t height;  ///< in 0.1 mm, like all steps
        std::int32_t step;    ///< smallest step known so far
    };

    void load(ImageView<const float> height_m);
    [[nodiscard]] std::size_t index(int ix, int iy) const noexcept {
        return static_cast<std::size_t>(iy + 1) * static_cast<std::size_t>(stride_) +
               static_cast<std::size_t>(ix + 1);
    }
    [[nodiscard]] Stance find_stance(const grid::GridGeometry& geometry,
                                     const Eigen::Vector2d& body_m);
    [[nodiscard]] double distance_of_nearest(const grid::GridGeometry& geometry,
                                             const Eigen::Vector2d& body_m);
    void gather(const grid::GridGeometry& geometry, const Eigen::Vector2d& body_m, double radius_m);
    [[nodiscard]] std::int32_t lowest_surface();
    void spread();
    /// `waiting`: number of used entries of `waiting_`. Returns the new number.
    [[nodiscard]] std::int32_t visit(std::int32_t cell, std::int32_t step, std::int32_t waiting);
    void write(grid::Layer& reach_step_m) const;

    double stance_radius_m_;
    std::int32_t max_step_;  ///< 0.1 mm
    int nx_ = 0;
    int ny_ = 0;
    int stride_ = 0;                    ///< row stride of `cells_`
    std::vector<Cell> cells_;           ///< cells with a rim of unknown cells
    std::vector<std::int32_t> stance_;  ///< candidates, then the cells of the stance
    std::vector<std::int32_t> sorted_;  ///< heights of the candidates
    std::vector<double> distance_m_;    ///< distances of all known cells from the body
    std::vector<std::int32_t>
        bucket_;  ///< first entry per step; the last buckets discard their entries
    std::vector<Waiting> waiting_;
};

}  // namespace surefoot::traversability
