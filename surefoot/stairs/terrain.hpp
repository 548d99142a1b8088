// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::stairs {

/// The camera that sees the ground now: the rectified left camera of the stereo pair.
struct View {
    Pose T_map_camera;  ///< optical frame: z forward, x right, y down
    double width_px = 0.0;
    double height_px = 0.0;
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double baseline_m = 0.0;
    /// Pixels with unmatched pixels this far away on both sides are not mapped (pixels.reach_px).
    double unmapped_px = 0.0;

    /// True if both cameras image the point at least 12 px inside the image. Ignores occlusion.
    [[nodiscard]] bool shows(const Eigen::Vector3d& p_map_m) const;
    /// Error of the range to a point, caused by a disparity error of `error_px`.
    [[nodiscard]] double range_error_m(double error_px,
                                       const Eigen::Vector2d& p_map_m,
                                       double z_map_m) const;
    /// Number of pixels that show level ground at a point, per square metre of ground; 0 behind or
    /// above the camera. Same formula as elevation::ExpectedPoints.
    [[nodiscard]] double pixels_per_m2(const Eigen::Vector3d& p_map_m) const;
    /// Length of the unmapped strip of level ground behind the mapped point `p_map_m` [m]:
    /// `unmapped_px` projected to the ground along `way` (unit vector, leads away from the camera).
    [[nodiscard]] double unmapped_m(const Eigen::Vector3d& p_map_m,
                                    const Eigen::Vector2d& way) const;
};

/// The known ground of one map. All layers have the size of `geometry` (row iy, column ix). Lengths
/// and positions are in the map frame (odom, z up).
struct Terrain {
    grid::GridGeometry geometry;
    ImageView<const float> height_m;       ///< highest surface of the cell; NaN = unknown
    ImageView<const float> height_var_m2;  ///< empty = 0
    /// Upper bound of the ground in an unknown cell: a ray passed at this height. Empty layer or
    /// NaN = no bound.
    ImageView<const float> free_above_m;
    ImageView<const float> clearance_m;  ///< free height above the cell; empty or NaN = open
    /// Number of measured points divided by the number that level ground would give. Vertical faces
    /// give values above 1. Empty layer or NaN = unknown.
    ImageView<const float> density_ratio;
    /// Number of observations that agree on the height; an empty layer means more than one.
    ImageView<const std::uint32_t> observations;
    /// Position of the machine. The side of the machine decides whether an edge leads up or down.
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();
    /// Camera of the current frame; empty = unknown. Ends of the ground are found only in its view.
    std::optional<View> view;
    /// Disparities of the current frame, including pixels that the map omits; NaN = no match.
    ImageView<const float> disparity_px;

    [[nodiscard]] bool known(int ix, int iy) const {
        return height_m.row(iy)[ix] == height_m.row(iy)[ix];
    }
};

}  // namespace surefoot::stairs
