// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "surefoot/elevation/elevation_layers.hpp"
#include "surefoot/elevation/fusion/cell_reduction.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Last alignment of each cell with the body, indexed by iy * nx + ix. A cell is aligned when its
/// height is set, when an observation agrees with it, or when the height drift corrects its height.
struct CellAlignment {
    const float* var_m2;        ///< height variance without the motion since the alignment
    const std::uint32_t* step;  ///< number of uncertain motions at the alignment
    std::uint8_t* is_asked;     ///< 1 = the cell has given its residual since the alignment
};

/// A cell that the map remembers and that a frame measured.
struct HeightResidual {
    Eigen::Vector2d at_m;           ///< position of the cell in odom
    Eigen::Vector2f from_camera_m;  ///< position from the point below the camera: ahead, left
    Eigen::Vector2f slope;          ///< slope of the map around the cell
    float height_m = 0.0F;          ///< height of the map
    float offset_m = 0.0F;          ///< measurement - map
    float var_m2 = 0.0F;            ///< variance of measurement plus map, without motion
    float motion_var_m2 = 0.0F;     ///< height variance of the motion since the alignment
    float drift_m = 0.0F;           ///< horizontal drift since the observation (1 sigma)
    std::uint32_t step = 0;         ///< see CellAlignment
    std::uint32_t seen_step = 0;    ///< number of uncertain motions at this frame
};

/// Height differences between frames and the map on the same ground. A frame shows little old
/// ground at once: a strip at the edge of its view, row by row. So residuals of old cells are kept
/// for a few motions. Each cell gives only its first residual until its next alignment.
class HeightResiduals {
  public:
    /// Limit of kept residuals: 10 m^2, if one of four cells of 25 mm is used.
    static constexpr std::size_t kMostOld = 4096;

    struct Input {
        const grid::GridGeometry& geometry;
        const ElevationLayers& layers;
        CellAlignment alignment;
        const CellMeasurement* measured;  ///< one entry per cell; 0 points = not measured
        Eigen::Vector2d camera_m;         ///< point below the camera, in odom
        Eigen::Vector2d ahead;            ///< forward direction of the body in odom, a unit vector
        std::uint32_t motions = 0;        ///< number of uncertain motions so far
        std::uint32_t min_motions = 0;
        std::uint32_t kept_motions = 0;
        double level_m = 0.0;
        double min_drift_m = 0.0;
    };
    /// Collects residuals from every second cell of every second row. Skips cells that are not
    /// level: the map two cells away, along x or y, is unknown or differs by more than `level_m`.
    /// Also skips cells that are not finite or have no variance. Returns the number of new
    /// residuals of old cells. Allocates only to grow.
    std::size_t gather(const Input& input);
    /// Deletes the residuals of old cells after their use.
    void forget() { old_.clear(); }

    /// Cells whose last alignment is at least `min_motions` motions ago, and whose height these
    /// motions may have moved by `min_drift_m` (1 sigma) or more.
    [[nodiscard]] const std::vector<HeightResidual>& old() const noexcept { return old_; }
    /// Cells aligned fewer than `min_motions` motions ago. They show this frame's own error.
    [[nodiscard]] const std::vector<HeightResidual>& recent() const noexcept { return recent_; }

  private:
    std::vector<HeightResidual> old_;
    std::vector<HeightResidual> recent_;
};

/// Returns the motion's share of a height variance, never negative; NaN for a NaN variance.
[[nodiscard]] constexpr float motion_variance(float height_var_m2, float aligned_var_m2) noexcept {
    const float more_m2 = height_var_m2 - aligned_var_m2;
    return more_m2 < 0.0F ? 0.0F : more_m2;
}

}  // namespace surefoot::elevation
