// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Settings for the removal of remembered surfaces by free-space evidence. All are an ASSUMPTION;
/// for their effects see docs/evidence/accuracy.md.
struct VisibilityConfig {
    bool cleanup = true;
    /// Lines of sight over unknown cells bound the depth of the ground there.
    bool drops = true;
    double margin_m = 0.05;  ///< lines of sight more than this below a height contradict the height
    double sigmas = 3.0;     ///< added to margin_m [sigma of the height]
    /// This many contradicting frames, without an agreeing frame between them, remove a surface
    /// that every observation showed. A surface in every third observation needs 3 times as many.
    int frames = 3;
    /// A neighbour of equal height that was confirmed within this time keeps the cell.
    double neighbour_s = 0.4;

    void describe(ConfigVisitor& visitor);
};

/// Free-space evidence of one frame: the space between the camera and a measured surface is empty.
/// So a remembered surface in that space is gone.
///
/// All lines start at the camera. In one direction, a line to a surface at distance r and height
/// dz over the camera is at r' < r at the height dz/r * r'. The lowest line over a position is the
/// line with the smallest dz/r among all that end beyond it. So one table over direction and
/// distance, with a running minimum from far to near, holds all lines. Its cost does not depend on
/// the length of the lines; the reference implementation casts them cell by cell in 199 ms a
/// frame.
///
/// Directions and distances refer to the diamond |x| + |y| = 1, to avoid square roots and angles.
class FreeSpaceRays {
  public:
    /// Starts a frame with the camera at `camera_m` in odom.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// Adds an observed surface at the height `z_m` in odom in that cell.
    void add(grid::Cell cell, float z_m);
    /// Call once after the last `add`.
    void finish();
    /// Returns the height in odom of the lowest line of sight over the middle of a cell. The line
    /// ends at least two cells beyond the cell. +inf without such a line.
    [[nodiscard]] float lowest_over(grid::Cell cell) const;

  private:
    /// Number of directions in a quarter of the diamond, and in the whole diamond.
    static constexpr int kQuarter = 256;
    static constexpr int kDirections = 4 * kQuarter;

    struct Place {
        float direction = 0.0F;  ///< [0, kDirections)
        float distance = 0.0F;   ///< |dx| + |dy| in cells
    };
    [[nodiscard]] Place place_of(float dx_cells, float dy_cells) const;
    /// Returns the quarter of the diamond in which a direction lies.
    [[nodiscard]] static std::size_t quarter_of(float dx_cells, float dy_cells) noexcept;

    grid::GridGeometry geometry_;
    float camera_x_ = 0.0F;  ///< position in cells from the corner of the grid
    float camera_y_ = 0.0F;
    float camera_z_m_ = 0.0F;
    int rings_ = 0;
    std::vector<float> lowest_;  ///< ring by ring: smallest slope dz/r of a line [m per cell]
    /// A camera points ahead, so quarters without any line are skipped.
    std::array<bool, 4> used_{};
};

}  // namespace surefoot::elevation
