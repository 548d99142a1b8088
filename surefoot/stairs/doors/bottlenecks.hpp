// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

struct BottleneckLimits {
    double min_width_m = 0.0;
    double max_width_m = 0.0;
    double max_depth_m = 0.0;
    double rise_m = 0.0;  ///< an object at least this high above the ground beside it is a wall
};

/// The narrowest place of free ground between two walls; accurate to one or two blocks.
struct Bottleneck {
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d across = Eigen::Vector2d::UnitX();  ///< unit vector from wall to wall
    double width_m = 0.0;
};

/// Finds bottlenecks on blocks of about 50 mm. A block is in a bottleneck if the circle about it
/// that reaches the nearest wall also touches a wall on its opposite side. Such blocks form a line
/// along a passage. A line longer than `max_depth_m` is a corridor, not a bottleneck.
///
/// Walls: blocks `rise_m` or more above the lowest level block within kReach_m, if not isolated.
///
/// Nearest walls: distance transform of Meijster, Roerdink and Hesselink (2000). Its cost is linear
/// in the number of blocks.
/// Owns the working memory; not thread-safe.
class BottleneckFinder {
  public:
    static constexpr double kBlock_m = 0.05;
    static constexpr double kReach_m = 0.15;

    /// Returns the bottlenecks, nearest to the stance first. The list is valid until the next call.
    const std::vector<Bottleneck>& find(const Terrain& terrain, const BottleneckLimits& limits);

  private:
    struct Parabola {
        int bx = 0;
        double from = 0.0;  ///< first column where this parabola is the lowest
    };

    void measure_blocks(const Terrain& terrain);
    void spread_ground();
    void mark_walls(double rise_m);
    void find_walls_in_columns();
    void find_nearest_walls(int by);
    void mark_bottlenecks(const BottleneckLimits& limits);
    [[nodiscard]] bool in_bottleneck(int bx, int by, const BottleneckLimits& limits) const;
    /// Adds the bottleneck of the marked blocks connected to `first`; clears their marks.
    void collect(grid::Cell first,
                 const grid::GridGeometry& geometry,
                 const BottleneckLimits& limits);
    /// Vector from the block to its nearest wall block. Precondition: a wall block exists.
    [[nodiscard]] Eigen::Vector2i to_wall(int bx, int by) const;

    int cells_ = 0;  ///< side of a block in cells
    double block_m_ = 0.0;
    int reach_ = 0;  ///< kReach_m in blocks
    int range_ = 0;  ///< half the width of the widest bottleneck in blocks, plus one
    /// Lowest height of level blocks in the square that begins at a block; +inf = none. With a
    /// margin of `reach_` blocks, the square about a block begins at the block's own index.
    Image<float> low_m_;
    Image<float> high_m_;  ///< highest cell of a block; -inf = unknown
    // One entry per column of cells, for one row of blocks.
    std::vector<float> column_low_m_;
    std::vector<float> column_high_m_;
    std::vector<int> column_known_;
    Image<std::uint8_t> wall_;
    Image<std::uint8_t> bottleneck_;
    Image<std::int16_t> wall_by_;  ///< row of the nearest wall block in the column; < 0 = none
    Image<std::int16_t> wall_bx_;  ///< column of the nearest wall block; < 0 = none
    std::vector<Parabola> envelope_;
    std::vector<grid::Cell> members_;
    std::vector<Bottleneck> bottlenecks_;
};

}  // namespace surefoot::stairs
