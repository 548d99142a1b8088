// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"

namespace surefoot::eval {

/// Points of a cloud (z up), sorted by the orientation of the surface around them. Points of other
/// orientations and points without a surface are left out. The orientation keeps the risers out of
/// the levels: heights alone would mix riser points into a level and lower it.
struct SortedSurfaces {
    std::vector<Eigen::Vector3f> level_m;    ///< normals within 20 deg of the vertical
    std::vector<Eigen::Vector3f> upright_m;  ///< normals within 20 deg of the horizontal
};
/// Size of the voxels in which sort_surfaces first thins the cloud to one mean point per voxel.
/// Without this step the dense part near a scanner would dominate.
inline constexpr double kSurfaceVoxel_m = 0.01;
/// Sorts points, which must be finite; `fits_voxels` must be true for their bounding box.
[[nodiscard]] SortedSurfaces sort_surfaces(std::span<const Eigen::Vector3f> points_m,
                                           Executor& executor = serial());

/// Settings for the detection of level surfaces from heights.
struct LevelConfig {
    double bin_m = 0.005;
    double least_step_m = 0.04;  ///< smallest distance between two levels
    double least_share = 5e-4;   ///< smallest share of all points in the bin of a level
    double prominence = 2.0;     ///< least count of a level divided by the median count around it
};

/// A level surface, or several surfaces at one height.
struct Level {
    double height_m = 0.0;  ///< height of the plane of the level at its centre
    double rms_m = 0.0;     ///< rms distance of the points from this plane
    double tilt_rad = 0.0;
    std::int64_t points = 0;
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
};

/// Histogram of point heights with its peaks.
struct HeightHistogram {
    double low_m = 0.0;  ///< lower end of the first bin
    double bin_m = 0.0;
    std::vector<std::int64_t> counts;
    std::vector<Level> levels;  ///< ascending
};
/// Points must be finite. Returns no counts without points, or for more than a million bins.
[[nodiscard]] HeightHistogram height_histogram(std::span<const Eigen::Vector3f> points_m,
                                               const LevelConfig& config = {});

/// Statistics of repeated measurements.
struct Repeated {
    std::vector<double> values_m;
    double mean_m = 0.0;       ///< NaN without values, like the other two figures
    double spread_m = 0.0;     ///< standard deviation (n - 1); 0 for one value
    double std_error_m = 0.0;  ///< standard error of the mean
};

/// Dimensions of stairs from their levels and riser faces.
struct StairMeasures {
    Repeated riser;  ///< height differences up to 0.30 m between successive levels
    Repeated going;  ///< distances between successive risers, from their faces or (in a map without
                     ///< faces) from the ends of the levels; only distances of 0.1 to 0.5 m
    Eigen::Vector2d uphill = Eigen::Vector2d::Zero();  ///< unit vector, or zero without two levels
};
/// Measures a flight: the longest sequence of equally spaced levels (within 8 %). Leaves out other
/// levels, for example patches between two treads or objects beside the stairs. For straight
/// flights only: measures along one uphill line. `levels`: levels of surfaces.level_m.
[[nodiscard]] StairMeasures measure_stairs(const SortedSurfaces& surfaces,
                                           std::span<const Level> levels);

/// Position and direction of a passage through a door.
struct DoorPlace {
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    double yaw_rad = 0.0;  ///< direction of the passage
    double floor_m = 0.0;
};
/// Returns the clear width between the nearest points left and right. Points count within 0.1 m of
/// the line across the passage, 0.3 to 1.8 m above the floor. No value if a side is open for 3 m.
[[nodiscard]] std::optional<double> door_width_m(std::span<const Eigen::Vector3f> points_m,
                                                 const DoorPlace& door);

}  // namespace surefoot::eval
