// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/stairs/doors/bottlenecks.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

struct DoorConfig {
    double min_width_m = 0.6;    ///< doors in buildings have 0.76 m and more
    double max_width_m = 1.4;    ///< pillars of a corridor stand that far apart and more
    double max_depth_m = 0.5;    ///< of the jambs, along the way; what is deeper is a corridor
    double rise_m = 0.2;         ///< what rises higher above the ground beside it is no ground
    double wall_height_m = 0.5;  ///< walls are seen to rise so high; a camera looks down on them
    double wall_length_m = 0.3;  ///< the wall goes on so far on both sides of the opening
    double min_sill_m = 0.008;   ///< lower ones are not told from the grain of the floor
    double sigma_factor = 3.0;   ///< a sill stands out of the floor by so many sigma
    /// Errors of a semi-global matcher are shared over 30-50 px: 0.1 m of floor 1 m away.
    double correlation_m = 0.1;
    /// Of where a matcher puts a jamb, besides what cells leave open: 20 rendered doors with the
    /// noise of the real ZED.
    double jamb_sigma_m = 0.006;
    /// What hangs over less than a square of this side may be a wrong match.
    double overhead_side_m = 0.05;

    void describe(ConfigVisitor& visitor);
    /// First reason why this cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Finds doorways and their sills: an opening between two walls in one line, with known ground
/// before, in and behind it.
///
/// Openings are looked for as necks of the free ground (see BottleneckFinder). On the cells follow
/// - yaw: the line through both walls. The noise of a wall lies along the line of sight, so that
///   all cells that stand in a band count, not the first of them;
/// - jambs: each row of cells across the opening (along the nearer axis of the grid) ends at the
///   first cell of wall. A jamb is where most rows end alike; those that end in the noise of a wall
///   do so farther from the middle;
/// - width: a cell that holds any bit of the wall shows the wall (Terrain: highest surface). So the
///   centre of the last cell of a row lies before the jamb by sin(yaw) / 2 cells on average, yaw
///   being that of the wall to that axis, and the width is corrected by that. What is left is even
///   over one cell where the wall lies along the grid, and less for oblique walls;
/// - sill: what stands out of the line from the ground before the jambs to that behind them. Its
///   sigma counts one error in each square of `correlation_m`.
///
/// Not found: doors with jambs deeper than `max_depth_m`, or less than 0.25 m beside a corner.
/// Holds the working memory: maps of one size allocate nothing after the first few.
class DoorFinder {
  public:
    explicit DoorFinder(const DoorConfig& config) : config_(config) {}
    [[nodiscard]] const DoorConfig& config() const noexcept { return config_; }
    /// Nearest to the stance first. Both lists are replaced; `sills` are those of `doors`.
    /// `config().problem()` is empty.
    void find(const Terrain& terrain, std::vector<Door>& doors, std::vector<LineFeature>& sills);

  private:
    struct Opening;
    struct Jamb;
    struct Sill;
    struct GroundLine;
    /// A known cell near an opening.
    struct Near {
        Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();  ///< from the middle of its neck
        float height_m = 0.0F;
        float var_m2 = 0.0F;
        float clearance_m = 0.0F;
    };
    /// Where a row of cells meets the wall, in the frame of the opening.
    struct RowEnd {
        double across_m = 0.0;  ///< from the middle
        double along_m = 0.0;
    };
    /// Mean height of the ground over the width of an opening.
    struct Bin {
        double sum_m = 0.0;
        double var_sum_m2 = 0.0;
        int count = 0;
        [[nodiscard]] double mean_m() const { return sum_m / count; }
    };

    [[nodiscard]] bool measure(const Terrain& terrain, Opening& opening);
    void gather(const Terrain& terrain, const Opening& opening);
    [[nodiscard]] std::optional<double> ground_m(const Terrain& terrain,
                                                 const Opening& opening,
                                                 double from_m,
                                                 double to_m);
    [[nodiscard]] bool turn_to_walls(Opening& opening) const;
    [[nodiscard]] std::optional<Jamb> jamb(const Terrain& terrain, const Opening& o, double side);
    void find_row_ends(const Terrain& terrain, const Opening& opening, double side);
    [[nodiscard]] bool has_wall(const Opening& opening, double side, const Jamb& jamb);
    [[nodiscard]] bool goes_on(const Opening& opening, double side, const Jamb& jamb) const;
    void take_profile(const Opening& opening);
    [[nodiscard]] GroundLine ground_line(const Opening& opening, double at_m, double far_m) const;
    [[nodiscard]] std::optional<Sill> sill(const Opening& opening);
    void report(const Opening& opening,
                const Sill& sill,
                std::vector<Door>& doors,
                std::vector<LineFeature>& sills);
    [[nodiscard]] double clearance_m(const Opening& opening);

    DoorConfig config_;
    BottleneckFinder bottlenecks_;
    double cell_m_ = 0.0;
    std::vector<Near> near_;
    std::vector<RowEnd> ends_;
    std::vector<float> values_;
    std::vector<std::uint8_t> hits_;
    std::vector<Bin> profile_;
};

}  // namespace surefoot::stairs
