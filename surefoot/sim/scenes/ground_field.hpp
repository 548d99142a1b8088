// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// Ground and obstacles on one vertical line, for a machine at a given level [world].
struct GroundSample {
    /// The highest surface up to the reach above the level, or the lowest surface if every surface
    /// is higher. NaN without any ground.
    double ground_m = std::numeric_limits<double>::quiet_NaN();
    /// Underside of the lowest solid that ends above the reach; infinity if the space is free.
    double underside_m = std::numeric_limits<double>::infinity();
    /// Top of the highest solid that ends above the reach; minus infinity if the space is free.
    double top_m = -std::numeric_limits<double>::infinity();
};

/// Scene geometry sampled every 5 mm on a lattice in a yawed frame. Sample (i, j) is at (i, j) *
/// spacing in that frame. So mirrored and rotated worlds are sampled alike. The samples are exact;
/// an object thinner than the spacing can fall between them.
class GroundField {
  public:
    static constexpr double kSpacing_m = 0.005;

    /// Inclusive index ranges.
    struct Range {
        int min_i = 0;
        int max_i = -1;
        int min_j = 0;
        int max_j = -1;
    };

    /// Up to 16 x 16 samples with bounds of their values, so that flat areas can be skipped.
    struct Tile {
        Range range;
        double lowest_ground_m = std::numeric_limits<double>::infinity();  ///< -inf = has a void
        double highest_ground_m = -std::numeric_limits<double>::infinity();
        double lowest_underside_m = std::numeric_limits<double>::infinity();
        double highest_top_m = -std::numeric_limits<double>::infinity();
    };

    /// `region` and `level` (height of the soles) are in the field's frame.
    GroundField(const Scene& scene,
                const PlanarPose& T_world_field,
                const Rect& region,
                const LevelPlane& level,
                double reach_m);

    [[nodiscard]] const PlanarPose& T_world_field() const noexcept { return T_world_field_; }
    [[nodiscard]] const Range& range() const noexcept { return range_; }
    /// Samples inside a rectangle, clipped to the field.
    [[nodiscard]] Range range_of(const Rect& area) const;
    [[nodiscard]] static Eigen::Vector2d point_m(int i, int j) {
        return {kSpacing_m * i, kSpacing_m * j};
    }
    [[nodiscard]] std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j - range_.min_j) * static_cast<std::size_t>(width()) +
               static_cast<std::size_t>(i - range_.min_i);
    }
    [[nodiscard]] const GroundSample& at(int i, int j) const { return samples_[index(i, j)]; }
    [[nodiscard]] const std::vector<Tile>& tiles() const noexcept { return tiles_; }

    /// 1 for every sample that is connected to `seeds` by ground without a jump of more than
    /// `jump_m` between neighbours; indexed by `index`.
    [[nodiscard]] std::vector<char> reached_from(const std::vector<Range>& seeds,
                                                 double jump_m) const;

  private:
    [[nodiscard]] int width() const { return range_.max_i - range_.min_i + 1; }
    [[nodiscard]] Tile summary(const Range& range) const;

    PlanarPose T_world_field_;
    Range range_;
    std::vector<GroundSample> samples_;
    std::vector<Tile> tiles_;
};

/// Samples one vertical line.
[[nodiscard]] GroundSample sample_ground(
    const Scene& scene, double x_m, double y_m, double level_m, double reach_m);

}  // namespace surefoot::sim
