// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {

/// The ground that a box of base_link passes over while base_link goes from one planar pose to
/// another: straight, and turning evenly on the way. A move without a turn is exact; a turn is cut
/// into pieces of half a degree, in each of which the box slides straight (2.6 mm for a corner
/// 0.6 m from base_link).
class SweptBox {
  public:
    /// `box` is in base_link; poses are in the frame in which `covers` is asked.
    SweptBox(const Rect& box, const PlanarPose& T_a_start, const PlanarPose& T_start_target);

    [[nodiscard]] bool covers(const Eigen::Vector2d& p_a) const;
    /// Axis-parallel rectangle around it.
    [[nodiscard]] const Rect& bounds() const noexcept { return bounds_; }

  private:
    struct Piece {
        PlanarPose T_a_box;        ///< at the beginning of the piece
        Eigen::Vector2d travel_m;  ///< to its end, in axes of the box
    };
    Rect box_;
    Rect bounds_;
    std::vector<Piece> pieces_;
};

/// The box made larger on all sides.
[[nodiscard]] Rect grown(const Rect& box, double by_m);

}  // namespace surefoot::sim
