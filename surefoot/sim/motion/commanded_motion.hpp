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

/// A REX under live command: it stands still, executes one commanded step completely, and stands
/// again. Commands never change the past. Thread-safe.
class CommandedMotion final : public Motion {
  public:
    /// Stands at `start` on `ground_z_m`, which is queried along the walk (see ground_of). Passes
    /// on errors of RexMotion::make, which has none for a stand without steps.
    [[nodiscard]] static Result<std::shared_ptr<CommandedMotion>> make(const RexStand& start,
                                                                       GroundHeight ground_z_m,
                                                                       const RexGaitConfig& gait,
                                                                       std::uint64_t seed);

    [[nodiscard]] MotionState at(double time_s) const override;
    /// Time at which the last commanded step ends.
    [[nodiscard]] double duration_s() const override;
    [[nodiscard]] std::optional<RexJoints> rex_joints(double time_s) const override;

    /// Starts the movement of a joystick code at `time_s`. Returns an error and changes nothing in
    /// three cases. The machine has no such movement. The previous step has not ended by then. The
    /// legs cannot make this step on the ground.
    [[nodiscard]] Result<StepEvent> step(int command, double time_s);
    [[nodiscard]] std::vector<StepEvent> steps() const;
    /// Drops steps that ended before `time_s`, so that memory stays bounded on long walks. Earlier
    /// queries then return the pose at which the kept motion begins.
    void forget_before(double time_s);

  private:
    struct Piece {
        double start_s = 0.0;
        RexMotion motion;
    };
    CommandedMotion(GroundHeight ground_z_m, const RexGaitConfig& gait, std::uint64_t seed);
    [[nodiscard]] Result<RexMotion> walk(const RexPlan& plan);
    /// Precondition: the caller holds the mutex.
    [[nodiscard]] const Piece& piece_at(double time_s) const;

    GroundHeight ground_z_m_;
    RexGaitConfig gait_;
    std::uint64_t seed_;
    std::vector<RexMovement> movements_;

    mutable std::mutex mutex_;   ///< protects the members below
    std::vector<Piece> pieces_;  ///< in time order; the first one is a stand
    std::vector<StepEvent> steps_;
    std::size_t walked_ = 0;  ///< number of pieces made so far
    RexStand stand_;          ///< stand after the last step
    double free_s_ = 0.0;
};

}  // namespace surefoot::sim
