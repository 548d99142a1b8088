// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::sim {

/// A disc of ground in the world for which an operator vouches.
struct VouchedGround {
    Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
};

/// The ground near a point that both cameras saw at once on the way (visibility_mask). It tells
/// whether the gate could know the ground of a movement. Uses the scene and the true poses alone:
/// no image, no depth and no map.
class SeenGround {
  public:
    /// Looks at the frames of `truth.trajectory` up to `until_ns`, for movements of the machine
    /// from poses within `radius_m` of `center_m`.
    SeenGround(const SceneTruth& truth,
               std::int64_t until_ns,
               const Machine& machine,
               const Eigen::Vector2d& center_m,
               double radius_m,
               Executor& executor);

    /// True if the whole zone of a movement was seen or is vouched for: the landing feet with their
    /// drop bands, and the ways of the feet with their margins. The ground below the body is not
    /// part of the zone. False for an unusable command.
    /// `T_world_body`: true pose of base_link before the movement.
    [[nodiscard]] bool holds_zone(const Machine& machine,
                                  const Pose& T_world_body,
                                  int command,
                                  const VouchedGround& vouched) const;

    /// The same for the ground below the space that the body, with its sway, enters. The body fills
    /// its present space itself.
    [[nodiscard]] bool holds_body(const Machine& machine,
                                  const Pose& T_world_body,
                                  int command,
                                  const VouchedGround& vouched) const;

  private:
    /// True if the cell was seen or is vouched for.
    [[nodiscard]] bool is_known(int ix, int iy, const VouchedGround& vouched) const;

    Lattice lattice_;
    Image<std::uint8_t> seen_;
};

}  // namespace surefoot::sim
