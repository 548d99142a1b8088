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

/// Since when the body's motion has blurred the cells, by iy * nx + ix. A cell is aligned with the
/// body when a look agrees with it, or when it is moved by what the height has drifted.
struct CellAlignment {
    const float* var_m2;        ///< variance of the height without the motion since then
    const std::uint32_t* step;  ///< how many uncertain motions there had been by then
    std::uint8_t* is_asked;     ///< has given its residual since then
};

/// A cell that the map remembers and a frame measured.
struct HeightResidual {
    Eigen::Vector2d at_m;           ///< in odom
    Eigen::Vector2f from_camera_m;  ///< from the camera's foot: ahead and to the left of the body
    Eigen::Vector2f slope;          ///< of the map around the cell
    float height_m = 0.0F;          ///< of the map
    float offset_m = 0.0F;          ///< measurement - map
    float var_m2 = 0.0F;            ///< of the measurement and of the map, without its motion
    float motion_var_m2 = 0.0F;     ///< of the height, from the motion since the cell was aligned
    float drift_m = 0.0F;           ///< 1 sigma, horizontal, since it was seen
    std::uint32_t step = 0;         ///< see CellAlignment
    std::uint32_t seen_step = 0;    ///< how many uncertain motions there had been now
};

/// What frames and the map say of the same ground. A frame sees little old ground at once: a strip
/// at the edge of its view, row by row. So residuals of old cells are kept for a few motions; every
/// cell gives one, the first, until it is aligned again.
class HeightResiduals {
  public:
    /// More are not kept: 10 m^2 of every fourth cell of 25 mm.
    static constexpr std::size_t kMostOld = 4096;

    struct Input {
        const grid::GridGeometry& geometry;
        const ElevationLayers& layers;
        CellAlignment alignment;
        const CellMeasurement* measured;  ///< every cell; no points = not measured
        Eigen::Vector2d camera_m;         ///< its foot in odom
        Eigen::Vector2d ahead;            ///< unit vector, of the body in odom
        std::uint32_t motions = 0;        ///< uncertain ones so far
        std::uint32_t min_motions = 0;
        std::uint32_t kept_motions = 0;
        double level_m = 0.0;
        double min_drift_m = 0.0;
    };
    /// Goes through every second cell of every second row. Left out are cells that are not level:
    /// the map two cells beside them, along x and y, is unknown or differs by more than `level_m`;
    /// and whatever is not finite or has no variance. Returns how many old cells gave a residual.
    /// Allocates only to grow.
    std::size_t gather(const Input& input);
    /// The residuals of old cells have been used.
    void forget() { old_.clear(); }

    /// Cells that were last aligned `min_motions` ago or earlier, and whose height the motion may
    /// have moved by `min_drift_m` (1 sigma) or more since.
    [[nodiscard]] const std::vector<HeightResidual>& old() const noexcept { return old_; }
    /// Cells that were aligned later than that: they can tell this frame's own error.
    [[nodiscard]] const std::vector<HeightResidual>& recent() const noexcept { return recent_; }

  private:
    std::vector<HeightResidual> old_;
    std::vector<HeightResidual> recent_;
};

/// The motion's share of a height variance, never negative; NaN where the variance is.
[[nodiscard]] constexpr float motion_variance(float height_var_m2, float aligned_var_m2) noexcept {
    const float more_m2 = height_var_m2 - aligned_var_m2;
    return more_m2 < 0.0F ? 0.0F : more_m2;
}

}  // namespace surefoot::elevation
