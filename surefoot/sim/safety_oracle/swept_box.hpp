// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {

/// The area that a rectangle in base_link passes over. base_link moves from one planar pose to
/// another, on a straight line at a constant turn rate. A move without a turn is exact. A turn is
/// cut into pieces of half a degree. The rectangle slides straight in each piece (error of 2.6 mm
/// for a corner 0.6 m from base_link).
class SweptBox {
  public:
    /// `box` is in base_link; the poses are in frame a, in which `covers` takes points.
    SweptBox(const Rect& box, const PlanarPose& T_a_start, const PlanarPose& T_start_target);

    [[nodiscard]] bool covers(const Eigen::Vector2d& p_a) const;
    /// Axis-parallel bounding rectangle of the whole sweep.
    [[nodiscard]] const Rect& bounds() const noexcept { return bounds_; }

  private:
    struct Piece {
        PlanarPose T_a_box;        ///< box pose at the beginning of the piece
        Eigen::Vector2d travel_m;  ///< way to the end of the piece, along the axes of the box
    };
    Rect box_;
    Rect bounds_;
    std::vector<Piece> pieces_;
};

/// The box, enlarged by `by_m` on all sides.
[[nodiscard]] Rect grown(const Rect& box, double by_m);

}  // namespace surefoot::sim
