// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/motion_script.hpp"
#include "surefoot/sim/motion/rex_gait.hpp"
#include "surefoot/sim/motion/rex_plan.hpp"
#include "surefoot/sim/motion/waypoint.hpp"

namespace surefoot::sim {

/// A REX that somebody steers: it stands until it is told to make a step, makes it to the end, and
/// stands again. The past never changes. Any thread may ask and command.
class CommandedMotion final : public Motion {
  public:
    /// Stands at `start` on `ground_z_m`, which is asked along the walk (see ground_of). A stand
    /// that the legs cannot take is a usage error.
    [[nodiscard]] static Result<std::shared_ptr<CommandedMotion>> make(const RexStand& start,
                                                                       GroundHeight ground_z_m,
                                                                       const RexGaitConfig& gait,
                                                                       std::uint64_t seed);

    [[nodiscard]] MotionState at(double time_s) const override;
    /// Until the last step that was commanded has ended.
    [[nodiscard]] double duration_s() const override;
    [[nodiscard]] std::optional<RexJoints> rex_joints(double time_s) const override;

    /// The machine begins the movement of a joystick code at `time_s`. An error, and nothing
    /// changes, where it has no such movement, the step before has not ended by then, or the legs
    /// cannot make it on this ground.
    [[nodiscard]] Result<StepEvent> step(int command, double time_s);
    [[nodiscard]] std::vector<StepEvent> steps() const;
    /// Steps that ended before `time_s` are not kept: who walks for hours would fill the memory.
    /// Before what is left, the machine is where that begins.
    void forget_before(double time_s);

  private:
    struct Piece {
        double start_s = 0.0;
        RexMotion motion;
    };
    CommandedMotion(GroundHeight ground_z_m, const RexGaitConfig& gait, std::uint64_t seed);
    [[nodiscard]] Result<RexMotion> walk(const RexPlan& plan);
    /// With the mutex held.
    [[nodiscard]] const Piece& piece_at(double time_s) const;

    GroundHeight ground_z_m_;
    RexGaitConfig gait_;
    std::uint64_t seed_;
    std::vector<RexMovement> movements_;

    mutable std::mutex mutex_;   ///< of what follows
    std::vector<Piece> pieces_;  ///< by time; the first one stands
    std::vector<StepEvent> steps_;
    std::size_t walked_ = 0;  ///< pieces that were made
    RexStand stand_;          ///< after the last step
    double free_s_ = 0.0;
};

}  // namespace surefoot::sim
