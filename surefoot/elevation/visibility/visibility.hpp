// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// When a remembered surface that lines of sight pass through is gone. ASSUMPTION, all of them;
/// what they lead to: docs/evidence/accuracy.md.
struct VisibilityConfig {
    bool cleanup = true;
    /// Lines of sight that pass over unknown cells say how deep the ground there must lie.
    bool drops = true;
    double margin_m = 0.05;  ///< lines this far below a height contradict it ...
    double sigmas = 3.0;     ///< ... plus this many sigma of the height
    /// Frames with such a line, and without a look that agrees in between, until a surface that
    /// every look had shown is gone; a surface seen in every third look gets three times as many.
    int frames = 3;
    /// A cell is vouched for by one beside it, as high, that a look agreed with this lately.
    double neighbour_s = 0.4;

    void describe(ConfigVisitor& visitor);
};

/// What the lines of sight of one frame say about the air in front of the measured surfaces: a line
/// of sight that ends at a surface has passed, at every nearer place in the same direction, through
/// nothing. So a remembered surface that stands in its way is gone.
///
/// All lines start at the camera. In one direction, a line to a surface at distance r and height dz
/// over the camera is at r' < r at the height dz/r * r': the lowest line over a place is the one
/// with the smallest dz/r among those that end beyond it. So one table of directions and distances,
/// with a running minimum from far to near, holds all of them, and its cost does not depend on how
/// long the lines are (casting them cell by cell costs the ancestor 199 ms a frame).
///
/// Directions and distances are those of the diamond |x| + |y| = 1: no square root, no angle.
class FreeSpaceRays {
  public:
    /// Starts a frame seen from a camera at `camera_m` in odom.
    void reset(const grid::GridGeometry& geometry, const Eigen::Vector3d& camera_m);
    /// A surface at the height `z_m` in odom was seen in that cell.
    void add(grid::Cell cell, float z_m);
    /// Call once after the last `add`.
    void finish();
    /// Height in odom of the lowest line of sight over the middle of a cell that ends at least two
    /// cells beyond it; +inf if there is none.
    [[nodiscard]] float lowest_over(grid::Cell cell) const;

  private:
    /// Directions in a quarter of the diamond, and all around.
    static constexpr int kQuarter = 256;
    static constexpr int kDirections = 4 * kQuarter;

    struct Place {
        float direction = 0.0F;  ///< [0, kDirections)
        float distance = 0.0F;   ///< |dx| + |dy| in cells
    };
    [[nodiscard]] Place place_of(float dx_cells, float dy_cells) const;
    /// In which quarter of the diamond a direction lies.
    [[nodiscard]] static std::size_t quarter_of(float dx_cells, float dy_cells) noexcept;

    grid::GridGeometry geometry_;
    float camera_x_ = 0.0F;  ///< in cells from the corner of the grid
    float camera_y_ = 0.0F;
    float camera_z_m_ = 0.0F;
    int rings_ = 0;
    std::vector<float> lowest_;  ///< ring by ring: smallest height over distance [m per cell]
    /// A camera looks ahead: the quarters that no line passes are left out.
    std::array<bool, 4> used_{};
};

}  // namespace surefoot::elevation
