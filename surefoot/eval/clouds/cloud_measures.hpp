// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"

namespace surefoot::eval {

/// Points of a cloud (z up) by how the surface around them lies; those between, and those without a
/// surface, are left out. Levels that are told by heights alone are drawn down by the faces of
/// risers below them.
struct SortedSurfaces {
    std::vector<Eigen::Vector3f> level_m;    ///< normals within 20 deg of the vertical
    std::vector<Eigen::Vector3f> upright_m;  ///< within 20 deg of the horizontal
};
/// The cloud is thinned to a point for each voxel of this size first, so that what is near to a
/// scanner does not count for more.
inline constexpr double kSurfaceVoxel_m = 0.01;
/// Points must be finite, and their box `fits_voxels`.
[[nodiscard]] SortedSurfaces sort_surfaces(std::span<const Eigen::Vector3f> points_m,
                                           Executor& executor = serial());

/// What heights say of level surfaces.
struct LevelConfig {
    double bin_m = 0.005;
    double least_step_m = 0.04;  ///< two levels are at least so far apart
    double least_share = 5e-4;   ///< of all points, in the bin of a level
    double prominence = 2.0;     ///< times the median of the bins around: walls fill all evenly
};

/// A level surface, or several at one height.
struct Level {
    double height_m = 0.0;  ///< of its plane at its middle
    double rms_m = 0.0;     ///< of its points across its plane
    double tilt_rad = 0.0;
    std::int64_t points = 0;
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
};

/// How many points lie how high, and the peaks.
struct HeightHistogram {
    double low_m = 0.0;  ///< where the first bin begins
    double bin_m = 0.0;
    std::vector<std::int64_t> counts;
    std::vector<Level> levels;  ///< ascending
};
/// Points must be finite. Empty where there are none, or where they span more than a million bins.
[[nodiscard]] HeightHistogram height_histogram(std::span<const Eigen::Vector3f> points_m,
                                               const LevelConfig& config = {});

/// Single values and what they have in common.
struct Repeated {
    std::vector<double> values_m;
    double mean_m = 0.0;       ///< NaN without values, as the others
    double spread_m = 0.0;     ///< standard deviation (n - 1); 0 for one value
    double std_error_m = 0.0;  ///< of the mean
};

/// Stairs whose levels are known: what one reads off histograms.
struct StairMeasures {
    Repeated riser;  ///< height differences of at most 0.30 m between the levels of the flight
    Repeated going;  ///< between the faces of risers, or where a map has none, the ends of levels;
                     ///< longer ones are landings and are left out
    Eigen::Vector2d uphill = Eigen::Vector2d::Zero();  ///< unit; zero with fewer than two levels
};
/// The flight is the longest row of levels with one riser (to 8 %); other levels, as patches
/// between two treads or things beside the stairs, are left out. For straight flights: places are
/// counted along one line uphill. `levels`: of the level points.
[[nodiscard]] StairMeasures measure_stairs(const SortedSurfaces& surfaces,
                                           std::span<const Level> levels);

/// Where a door is passed.
struct DoorPlace {
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    double yaw_rad = 0.0;  ///< of the way through
    double floor_m = 0.0;
};
/// Clear width between what stands to the left and to the right within 0.1 m of the line across the
/// way, 0.3 to 1.8 m above the floor. Nothing where a side is open for 3 m.
[[nodiscard]] std::optional<double> door_width_m(std::span<const Eigen::Vector3f> points_m,
                                                 const DoorPlace& door);

}  // namespace surefoot::eval
