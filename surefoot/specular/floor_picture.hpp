// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/moving_window.hpp"
#include "surefoot/grid/sliding_layer.hpp"
#include "surefoot/specular/specular_config.hpp"

namespace surefoot::specular {

/// Top view of the floor: the mean brightness of each cell of a level plane in odom, over all
/// frames that saw the plane there. The reflection of the floor in a mirror or a pane of glass lies
/// in the same plane and therefore enters the picture too.
///
/// Order of calls: `follow` and `add` for every frame. No allocation after construction.
class FloorPicture {
  public:
    explicit FloorPicture(const SpecularConfig& config);

    /// Moves the window if the body has moved too far inside it. The window lies ahead of the body.
    void follow(const Pose& T_odom_body);
    /// Adds the part of a rectified left image that shows the plane z = `floor_z_m` (odom). Each
    /// frame fills a quarter of the picture's rows. Pixels off the plane do not count.
    void add(const camera::RectifiedRig& rig,
             const Pose& T_odom_body,
             ImageView<const std::uint8_t> left,
             ImageView<const float> disparity_px,
             double floor_z_m);
    /// Clears the picture.
    void clear();

    [[nodiscard]] const grid::GridGeometry& geometry() const noexcept { return window_.geometry(); }
    /// Returns the mean grey value of each cell; NaN = not observed.
    [[nodiscard]] ImageView<const float> brightness() const noexcept { return grey_.view(); }

  private:
    struct View;
    void add_row(const View& view, int iy, double y_m);

    double range_m_;
    grid::MovingWindow window_;
    grid::SlidingLayer<float> grey_;
    grid::SlidingLayer<float> weight_;
    unsigned frame_ = 0;
};

}  // namespace surefoot::specular
