// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/motion/rex_kinematics.hpp"
#include "surefoot/sim/motion/rex_plan.hpp"
#include "surefoot/sim/motion/smooth_curve.hpp"

namespace surefoot::sim {

/// What is drawn anew for every step lies between `low` and `high`.
struct Spread {
    double low = 0.0;
    double high = 0.0;
};

/// Everything but the step time and what the gait trace gives is an ASSUMPTION after the proposed
/// model of the project's safety notes, to be replaced when somebody has recorded a REX.
struct RexGaitConfig {
    double step_s = 10.0;                ///< 0.35 m at the data sheet's 0.0347 m/s
    double settle_s = 1.5;               ///< of it: standing until the frame has stopped ringing
    double foot_clearance_m = 0.01;      ///< of the toes of a swinging foot; ankles rise by 22 mm
    Spread lateral_shift_m{0.10, 0.11};  ///< of base_link over the standing foot, to each side
    Spread roll_deg{3.0, 4.0};           ///< toward the standing foot
    Spread yaw_deg{1.5, 3.0};            ///< toward the foot behind
    Spread ring_hz{2.0, 6.0};            ///< structural ringing after a foot strike
    Spread ring_mm{1.0, 3.0};            ///< its largest deflection, vertical
    Spread ring_deg{0.1, 0.3};           ///< its largest roll and pitch
    Spread strike_m_s2{0.5, 2.0};        ///< vertical acceleration pulse of a foot strike
    bool ground_under_body = false;  ///< ask for the ground below base_link instead of each sole
};

/// Foot in the world. It stands flat, also on a ramp.
struct FootState {
    Pose T_world_sole;    ///< below the ankle
    bool carries = true;  ///< stands flat; false while it swings or has its heel up
};

/// Quasi-static walk of the REX. A step is the gait trace: the leading foot goes half the way, the
/// other one past it to the end, the first one closes; the machine stands with parallel feet before
/// and after. A backward step is the trace played backwards. On stairs, where half a tread is no
/// place to stand, the leading foot goes the whole way.
///
/// Base_link's way, pitch and bob come from the trace: in every sample the standing leg (between
/// two standing feet a mean of both, by load) carries the pelvis, whose pitch makes the sole flat.
/// They are scaled to the length of the step; the shift of weight lies over it; where a leg would
/// be too short the pelvis sinks. All are cubic B-splines of those samples, so the acceleration is
/// continuous; the sharp transition is the foot strike, a pulse of 0.12 s, and the ringing after
/// it. Feet are exact, legs follow by inverse kinematics, so a standing foot never slips; a foot
/// that stays behind lifts its heel before it swings, as in the trace. Roll, yaw, ringing and pulse
/// are the frame giving way above the hips (the trace's pelvis has none of them): `at` shows them,
/// `pelvis` and `joints` do not.
class RexMotion final : public Motion {
  public:
    /// A step that the legs cannot reach, or with a joint outside its range on level ground, is a
    /// usage error. Stepping up and down only asks for reach: lifting the heel is not modelled.
    [[nodiscard]] static Result<RexMotion> make(const RexPlan& plan,
                                                const RexGaitConfig& config,
                                                const GroundHeight& ground_z_m,
                                                std::uint64_t seed);

    [[nodiscard]] MotionState at(double time_s) const override;
    [[nodiscard]] double duration_s() const override { return duration_s_; }
    /// The legs as in `joints`; the frame as it sways, with which the feet of a REX that is drawn
    /// at base_link stay where they stand (but for what rings up and down, a few millimetres).
    [[nodiscard]] std::optional<RexJoints> rex_joints(double time_s) const override;

    /// What the legs carry: base_link without sway, ringing and strike pulses.
    [[nodiscard]] Pose pelvis(double time_s) const;
    [[nodiscard]] FootState foot(Side side, double time_s) const;
    [[nodiscard]] LegAngles joints(Side side, double time_s) const;

    /// One step of the plan: when, and where base_link stands before and after, level.
    struct Span {
        double start_s = 0.0;
        double end_s = 0.0;
        Pose T_world_before;
        Pose T_world_after;
    };
    [[nodiscard]] const std::vector<Span>& steps() const noexcept { return steps_; }

  private:
    friend class RexMotionBuilder;
    struct Body {
        double start_s = 0.0;
        std::array<SmoothCurve, 3> position_m;
        SmoothCurve pitch_rad;
        SmoothCurve yaw_rad;
        SmoothCurve sway_roll_rad;
        SmoothCurve sway_yaw_rad;
    };
    struct Swing {
        double heel_up_s = 0.0;  ///< the heel leaves the ground, the toes stay
        double start_s = 0.0;
        double end_s = 0.0;  ///< the toes land
        double heel_down_s = 0.0;
        double lift_rad = 0.0;  ///< of the sole about the toes
        Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
        Eigen::Vector3d to_m = Eigen::Vector3d::Zero();
        double from_yaw_rad = 0.0;
        double to_yaw_rad = 0.0;
        double clearance_m = 0.0;
    };
    struct Strike {
        double time_s = 0.0;
        double omega_rad_s = 0.0;
        std::array<double, 3> ring_m{};
        std::array<double, 3> ring_rad{};
        double pulse_m_s2 = 0.0;
    };
    RexMotion() = default;
    [[nodiscard]] static double lifted(const Swing& swing, double time_s, double share);
    [[nodiscard]] const Body& body(double time_s) const;
    [[nodiscard]] std::optional<LegAngles> leg(Side side, double time_s) const;

    std::vector<Body> bodies_;                  ///< by time; the first one stands
    std::array<std::vector<Swing>, 2> swings_;  ///< per side, by time; the first one is the start
    std::vector<Strike> strikes_;               ///< by time
    std::vector<Span> steps_;
    double duration_s_ = 0.0;
};

}  // namespace surefoot::sim
