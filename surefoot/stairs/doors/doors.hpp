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
    double max_width_m = 1.4;    ///< pillars of a corridor are at least this far apart
    double max_depth_m = 0.5;    ///< jamb depth along the way; deeper passages are corridors
    double rise_m = 0.2;         ///< a cell this high above the ground beside it is not ground
    double wall_height_m = 0.5;  ///< smallest visible wall height; the camera looks down on walls
    double wall_length_m = 0.3;  ///< smallest length of the wall on each side of the opening
    double min_sill_m = 0.008;   ///< lower sills cannot be distinguished from floor noise
    double sigma_factor = 3.0;   ///< smallest height of a sill above the floor [sigma]
    /// Correlation length of semi-global matching errors: 30-50 px, which is 0.1 m of floor at 1 m.
    double correlation_m = 0.1;
    /// One sigma of a jamb's position beyond cell quantisation. Source: 20 rendered doors with the
    /// noise of the real ZED.
    double jamb_sigma_m = 0.006;
    /// An overhead object smaller than a square of this side may be a wrong match.
    double overhead_side_m = 0.05;

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why these settings are invalid, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Finds doorways and their sills. A doorway is an opening between two walls in one line, with
/// known ground before, in and behind it.
///
/// Candidates are bottlenecks of the free ground (BottleneckFinder). Then the cells give:
/// - yaw: the line through both walls. All wall cells in a band count, not only the first
///   ones, because the noise of a wall lies along the ray;
/// - jambs: a row of cells across the opening (along the nearer grid axis) ends at its first wall
///   cell. The jamb is the innermost place where many rows end, because noise makes other rows
///   end farther from the middle;
/// - width: a cell that contains any part of the wall shows the wall (Terrain: highest surface). So
///   the first wall cell's centre lies sin(yaw) / 2 cells before the jamb on average (yaw: wall to
///   axis); the width is corrected by this. The remaining error is uniform over one cell for a wall
///   along the grid, and smaller for an oblique wall;
/// - sill: the height above the line between the ground before and behind the jambs, or above both
///   if they differ by a step. Its sigma counts one independent error per `correlation_m` squared.
///
/// Not found: doors with jambs deeper than `max_depth_m`, or within 0.25 m of a corner.
/// Owns the working memory: maps of one size allocate nothing after the first few calls.
class DoorFinder {
  public:
    explicit DoorFinder(const DoorConfig& config) : config_(config) {}
    [[nodiscard]] const DoorConfig& config() const noexcept { return config_; }
    /// Replaces both lists, nearest door to the stance first; `sills` holds the sills of `doors`.
    /// Precondition: `config().problem()` is empty.
    void find(const Terrain& terrain, std::vector<Door>& doors, std::vector<LineFeature>& sills);

  private:
    struct Opening;
    struct Jamb;
    struct Sill;
    struct GroundLine;
    /// A known cell near an opening.
    struct Near {
        Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();  ///< offset from the bottleneck middle
        float height_m = 0.0F;
        float var_m2 = 0.0F;
        float clearance_m = 0.0F;
    };
    /// The point where a row of cells meets the wall, in the frame of the opening.
    struct RowEnd {
        double across_m = 0.0;  ///< offset from the middle of the opening
        double along_m = 0.0;
    };
    /// Sums of the ground heights over the width of an opening, at one position along the way.
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
