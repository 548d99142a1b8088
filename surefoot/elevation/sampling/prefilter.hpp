// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"

namespace surefoot::elevation {

/// Filters that remove points before they reach the map. Each filter has its own switch.
struct PrefilterConfig {
    bool range = true;
    double min_range_m = 0.3;
    double max_range_m = 20.0;
    bool height = true;
    /// Relative to base_link; the floor lies near -1 m. Ground below the limit has no height in the
    /// map, but is evidence of a drop (`free_above_m`).
    double min_height_m = -3.0;
    double max_height_m = 1.0;   ///< excludes lintels and ceilings
    bool down_sampling = false;  ///< not needed where cells reduce their points
    double sampling_m = 0.01;
    bool outlier_removal = false;
    double outlier_radius_m = 0.25;
    int outlier_min_neighbours = 5;

    void describe(ConfigVisitor& visitor);
};

/// True if the filter is off or the range is within its limits. NaN is not within the limits.
[[nodiscard]] inline bool is_in_range(const PrefilterConfig& config, double range_m) noexcept {
    return !config.range || (range_m >= config.min_range_m && range_m <= config.max_range_m);
}
/// Returns the lower height limit in odom.
[[nodiscard]] inline float lowest_z_m(const PrefilterConfig& config,
                                      const Pose& T_odom_body) noexcept {
    return config.height ? static_cast<float>(T_odom_body.translation_m.z() + config.min_height_m)
                         : -std::numeric_limits<float>::infinity();
}
/// True if the filter is off or the height over base_link is within the upper limit (NaN is not).
/// The lower limit acts on the heights of cells: many points that are too deep show a drop.
[[nodiscard]] inline bool is_in_height(const PrefilterConfig& config, double over_body_m) noexcept {
    return !config.height || over_body_m <= config.max_height_m;
}

/// The two filters that need the whole cloud. The positions of the points count from the corner of
/// a grid; all points are finite and lie over or near the grid. The order of the points stays. Does
/// not allocate once its tables have grown.
class CloudFilter {
  public:
    /// Keeps one point per cube of `sampling_m`: the point nearest to the centre of the cube, the
    /// first of equals. Returns the number of kept points, at the front of `points`.
    std::size_t down_sample(double sampling_m, std::span<GridPoint> points);
    /// Drops points with fewer than `min_neighbours` other points within `radius_m`, in 3D.
    std::size_t remove_outliers(double radius_m, int min_neighbours, std::span<GridPoint> points);

  private:
    struct Cube {
        std::int32_t x = 0;
        std::int32_t y = 0;
        std::int32_t z = 0;
        friend bool operator==(const Cube&, const Cube&) = default;
    };
    static constexpr std::uint32_t kNone = 0xffffffffU;

    [[nodiscard]] static Cube cube_of(const GridPoint& point, double edge_m);
    void reset_table(std::size_t points);
    /// Returns the slot of the open-addressing table that holds a cube, or else an empty slot.
    [[nodiscard]] std::size_t slot_of(const Cube& cube) const;
    void link(std::span<const GridPoint> points, double edge_m);
    [[nodiscard]] int count_neighbours(std::span<const GridPoint> points,
                                       std::size_t of,
                                       double radius_m,
                                       int enough) const;

    std::vector<std::uint32_t> first_;  ///< hash table of cubes: one point of each cube
    std::vector<Cube> cubes_;           ///< one cube per point
    std::vector<std::uint32_t> next_;   ///< per point: the next point in the same cube
    std::vector<std::uint8_t> keep_;
};

}  // namespace surefoot::elevation
