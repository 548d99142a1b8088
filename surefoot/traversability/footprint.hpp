// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/cell_run.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::traversability {

/// Outline of a foot, a robot or a path's cross-section on the ground, in its own frame: a circle
/// around the origin, or a convex polygon anywhere.
class Footprint {
  public:
    static constexpr int kMaxVertices = 16;
    /// Larger outlines are refused: their unit is probably wrong.
    static constexpr double kMaxReach_m = 100.0;

    /// Makes a circle. Needs 0 < radius_m <= kMaxReach_m.
    [[nodiscard]] static Result<Footprint> circle(double radius_m);
    /// Makes a convex polygon. Needs 3 to kMaxVertices finite vertices with an area, clockwise or
    /// counter-clockwise; vertices on a straight edge are allowed.
    [[nodiscard]] static Result<Footprint> polygon(std::span<const Eigen::Vector2d> vertices_m);

    /// Corners of a polygon; for a circle its centre, with `radius_m` above 0.
    [[nodiscard]] std::span<const Eigen::Vector2d> points_m() const noexcept {
        return {points_m_.data(), static_cast<std::size_t>(count_)};
    }
    [[nodiscard]] double radius_m() const noexcept { return radius_m_; }
    /// Largest distance of a corner from the origin of its frame.
    [[nodiscard]] double reach_m() const noexcept { return reach_m_; }

  private:
    Footprint() = default;
    std::array<Eigen::Vector2d, kMaxVertices> points_m_;
    int count_ = 0;
    double radius_m_ = 0.0;
    double reach_m_ = 0.0;
};

/// Pose of a footprint in the frame of the map (odom); yaw from x towards y.
struct FootprintPose {
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_rad = 0.0;
};

/// The layers that a query reads; NaN = unknown.
struct FootprintLayers {
    grid::GridGeometry geometry;
    ImageView<const float> rating;    ///< traversability, 1 to 0 (or any other rating)
    ImageView<const float> height_m;  ///< empty = heights are not evaluated
};

enum class FootprintOutcome : std::uint8_t {
    invalid_pose,  ///< no pose, or a pose that is not finite or lies beyond 2^20 cells:
                   ///< no cells were read
    invalid_map,   ///< no cell size, or layers of another size than the grid: no cells were read
    outside_map,   ///< cells were counted, but none lies in the map
    rated,         ///< at least one cell lies in the map; it may be unknown
};

/// Cells under a footprint. No policy accepts a default-constructed report.
struct FootprintReport {
    FootprintOutcome outcome = FootprintOutcome::invalid_pose;
    std::int64_t cells = 0;           ///< cells that the shape overlaps, each counted once
    std::int64_t outside = 0;         ///< cells beyond the map
    std::int64_t unknown = 0;         ///< cells without a rating (cells outside included)
    std::int64_t without_height = 0;  ///< cells without a height (cells outside included);
                                      ///< 0 if no height layer was given
    float worst_rating = std::numeric_limits<float>::quiet_NaN();   ///< worst of the rated cells
    std::optional<grid::Cell> worst_cell;                           ///< first such cell, by rows
    double mean_rating = std::numeric_limits<double>::quiet_NaN();  ///< mean of the rated cells
    float lowest_m = std::numeric_limits<float>::quiet_NaN();       ///< lowest known height
    float highest_m = std::numeric_limits<float>::quiet_NaN();

    /// Returns the share of cells without a rating; 1 if there are no cells.
    [[nodiscard]] double unknown_share() const noexcept {
        return cells > 0 ? static_cast<double>(unknown) / static_cast<double>(cells) : 1.0;
    }
    /// Returns highest minus lowest height; NaN without a known height.
    [[nodiscard]] float height_range_m() const noexcept { return highest_m - lowest_m; }
};

/// Treatment of unknown cells under a footprint.
enum class UnknownPolicy : std::uint8_t {
    unsafe,   ///< refuse if any cell has no rating, has no height or lies outside
    ignored,  ///< consider only rated cells; for far planning, never for a step
};

/// True if every rated cell has a rating above 0 of at least `threshold`, and the policy accepts
/// the other cells. False without any rated cell. This is a rating, not a verdict: the step gate
/// decides about steps.
[[nodiscard]] bool is_traversable(const FootprintReport& report,
                                  double threshold,
                                  UnknownPolicy policy = UnknownPolicy::unsafe) noexcept;

/// Reports on every cell that the footprint at that pose overlaps, in one pass. Cells with a centre
/// outside the footprint count too: a foot on half a cell stands on it.
///
/// Reads only and keeps no state: thread-safe, and equal inputs give equal results. Allocates
/// nothing. Cost: proportional to the cells.
[[nodiscard]] FootprintReport query(const Footprint& footprint,
                                    const FootprintPose& pose,
                                    const FootprintLayers& layers) noexcept;

/// Working memory of path queries; one per thread. Reuse saves allocations.
struct PathScratch {
    std::vector<grid::CellRun> runs;
};

/// Does the same for all cells that the footprint overlaps along the poses, each cell once. Between
/// poses the footprint moves straight and turns the short way at an even rate (also on the spot).
///
/// A turn is cut into pieces of at most kMaxTurn_rad. Each piece is the convex hull of its two
/// ends, enlarged by the bulge of the arcs. So no cell is missed; cells beside a turn may count
/// too: up to reach * turn / 2 away (6 mm for a reach of 0.25 m).
[[nodiscard]] FootprintReport query_path(const Footprint& footprint,
                                         std::span<const FootprintPose> poses,
                                         const FootprintLayers& layers,
                                         PathScratch& scratch);

/// Largest turn within one piece of a path.
inline constexpr double kMaxTurn_rad = 0.05;

}  // namespace surefoot::traversability
