// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::stairs {

/// The camera that sees the ground now: rectified left eye of a pair.
struct View {
    Pose T_map_camera;  ///< optical frame: z forward, x right, y down
    double width_px = 0.0;
    double height_px = 0.0;
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double baseline_m = 0.0;
    /// So near to where nothing is matched pixels are not mapped (elevation.pixels.reach_px).
    double unmapped_px = 0.0;

    /// Both eyes see the place, if nothing is in between, and not at the border of their images.
    [[nodiscard]] bool shows(const Eigen::Vector3d& p_map_m) const;
    /// What an error of the disparity makes of the range to a place.
    [[nodiscard]] double range_error_m(double error_px,
                                       const Eigen::Vector2d& p_map_m,
                                       double z_map_m) const;
    /// How many pixels show level ground at a place, for each square metre of it; 0 behind or above
    /// the camera. As elevation::ExpectedPoints.
    [[nodiscard]] double pixels_per_m2(const Eigen::Vector3d& p_map_m) const;
    /// How far level ground goes on, along `way`, beyond the last place of it that is mapped [m]:
    /// `unmapped_px` on the ground. `way`: unit vector that leads away from the camera.
    [[nodiscard]] double unmapped_m(const Eigen::Vector3d& p_map_m,
                                    const Eigen::Vector2d& way) const;
};

/// What is known of the ground; all layers have the size of `geometry`, row iy, column ix. Lengths
/// and places are those of the map's frame (odom, z up).
struct Terrain {
    grid::GridGeometry geometry;
    ImageView<const float> height_m;       ///< highest surface of the cell; NaN = unknown
    ImageView<const float> height_var_m2;  ///< empty = 0
    /// Of unknown cells: lines of sight passed at this height, ground there lies lower. Empty or
    /// NaN = nothing is known.
    ImageView<const float> free_above_m;
    ImageView<const float> clearance_m;  ///< free height above the cell; empty or NaN = open
    /// Points seen over points that level ground would show: vertical faces show many times more.
    /// Empty or NaN = nothing is known.
    ImageView<const float> density_ratio;
    /// Looks that agree on the height; empty = more than one.
    ImageView<const std::uint32_t> observations;
    /// Where the machine stands: what goes down from there is a drop, what goes up is not.
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();
    /// Where ground that goes on would be seen; without it nothing is said of ground that ends.
    std::optional<View> view;
    /// What that camera sees now, also what the map leaves out; NaN = no match, empty = nothing.
    ImageView<const float> disparity_px;

    [[nodiscard]] bool known(int ix, int iy) const {
        return height_m.row(iy)[ix] == height_m.row(iy)[ix];
    }
};

}  // namespace surefoot::stairs
