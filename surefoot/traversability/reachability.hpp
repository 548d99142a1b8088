// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/traversability_config.hpp"

namespace surefoot::traversability {

/// Where the machine was taken to stand.
struct Stance {
    int cells = 0;          ///< ways begin in these; 0 when the map holds no known cell
    double lowest_m = 0.0;  ///< of these cells, in the frame of the map; 0 without any
    double radius_m = 0.0;  ///< they were looked for within this distance of the body
};

/// Which ground can be walked to from where the machine stands, and over which steps: a table top
/// is flat but not reachable.
///
/// reach_step_m of a cell = the smallest, over all ways to it from the stance, of the largest
/// height difference between two cells that follow each other on the way (a minimax path). Ways
/// lead from known cell to known 4-neighbour; an unknown cell is never crossed and no gap is
/// bridged, not even of one cell. Up and down count alike: the least step up and the least step
/// down may lie on different ways, so two layers would promise a way that is not there. Heights are
/// rounded to 0.1 mm as for the gate, and the result is exact on them, whatever the order in which
/// cells are visited.
///
/// NaN = unknown, or only to be reached over a step above `max_step_m`, or not at all; the height
/// tells the first from the others. Every comparison with it is false, so that `<= limit` never
/// takes it for reachable. A ramp has no steps: how steep a way is, the slope says. And a riser
/// counts by its parts where cells lie at heights in between: on an edge that the map has smeared,
/// steps are lower than the riser.
///
/// The stance: known cells with their centre within `stance_radius_m` of the body along the ground.
/// If they are fewer than kStanceCells (the ground at the feet is not in view), the radius becomes
/// the distance within which so many are known, or all there are, plus `stance_radius_m`. Of these
/// the lowest surface counts, because a table top may hang over the feet: the lowest kSurface_m of
/// height in which a quarter of them lie, so that neither a stray low cell nor the pit beside a
/// landing is taken for it (if there is none, the fullest kSurface_m). The height of the body is
/// not asked: base_link may be anywhere above the ground.
///
/// Cost: four looks per known cell, plus one visit per 0.1 mm of `max_step_m` (Dijkstra 1959 with
/// one bucket per length, Dial 1969). Allocates only to grow. Not thread-safe.
class Reachability {
  public:
    static constexpr int kStanceCells = 16;     ///< about a foot: 0.01 m2 at 25 mm
    static constexpr double kSurface_m = 0.05;  ///< heights of one surface under the body
    /// Beyond it a height is unknown, as for the gate.
    static constexpr double kHighest_m = 1000.0;

    explicit Reachability(const TraversabilityConfig::Reach& config);

    /// `height_m`: one row per iy of `geometry`, NaN = unknown; `body_m`: in its frame.
    /// `reach_step_m` takes the size of the map.
    Stance reach(const grid::GridGeometry& geometry,
                 ImageView<const float> height_m,
                 const Eigen::Vector2d& body_m,
                 grid::Layer& reach_step_m);

  private:
    /// A cell waits for the step that leads to it; the next one waits for the same.
    struct Waiting {
        std::int32_t cell;
        std::int32_t next;
    };
    struct Cell {
        std::int32_t height;  ///< 0.1 mm, as all steps
        std::int32_t step;    ///< least known so far
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
    /// `waiting`: places of `waiting_` in use; returns how many are now.
    [[nodiscard]] std::int32_t visit(std::int32_t cell, std::int32_t step, std::int32_t waiting);
    void write(grid::Layer& reach_step_m) const;

    double stance_radius_m_;
    std::int32_t max_step_;  ///< 0.1 mm
    int nx_ = 0;
    int ny_ = 0;
    int stride_ = 0;                    ///< of `cells_`
    std::vector<Cell> cells_;           ///< with a rim of unknown ones
    std::vector<std::int32_t> stance_;  ///< candidates, then the cells of the stance
    std::vector<std::int32_t> sorted_;  ///< heights of the candidates
    std::vector<double> distance_m_;    ///< of all known cells from the body
    std::vector<std::int32_t>
        bucket_;  ///< first that waits for a step, by step; the last one for nobody
    std::vector<Waiting> waiting_;
};

}  // namespace surefoot::traversability
