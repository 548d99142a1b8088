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

/// Range from which a value is drawn for every step.
struct Spread {
    double low = 0.0;
    double high = 0.0;
};

/// ASSUMPTION: every value except the step time, which follows from the data sheet. Replace the
/// values when a recording of a real REX exists.
struct RexGaitConfig {
    double step_s = 10.0;                ///< step time: 0.35 m at the data sheet's 0.0347 m/s
    double settle_s = 1.5;               ///< standing time within step_s, until the ringing stops
    double foot_clearance_m = 0.01;      ///< largest lift of the toes; leading ankle: 22 mm
    Spread lateral_shift_m{0.10, 0.11};  ///< sway of base_link over the standing foot, to each side
    Spread roll_deg{3.0, 4.0};           ///< roll of base_link toward the standing foot
    Spread yaw_deg{1.5, 3.0};            ///< yaw of base_link toward the foot behind
    Spread ring_hz{2.0, 6.0};            ///< frequency of the ringing after a foot strike
    Spread ring_mm{1.0, 3.0};            ///< largest vertical deflection of the ringing
    Spread ring_deg{0.1, 0.3};           ///< largest roll and pitch of the ringing
    Spread strike_m_s2{0.5, 2.0};        ///< vertical acceleration pulse of a foot strike
    bool ground_under_body = false;      ///< true: query the ground below base_link, not the soles
};

/// Pose of one foot in the world. A foot stands flat on the ground, also on a ramp.
struct FootState {
    Pose T_world_sole;    ///< point of the sole below the ankle
    bool carries = true;  ///< true: stands flat; false: swings or has its heel up
};

/// Quasi-static walk of the REX. A step plays the gait trace: the leading foot moves half the way,
/// the other foot passes it to the end, the first foot closes. The machine stands with parallel
/// feet before and after a step. A backward step plays the trace backward. On stairs the leading
/// foot moves the whole way, because nobody can stand on half a tread.
///
/// The trace gives the path, pitch and bob of base_link. In every sample the standing leg carries
/// the pelvis, and the pitch of the pelvis makes its sole flat. With two standing feet, path and
/// pitch are means weighted by load. These values scale with the step length. The shift of weight
/// is added. The pelvis sinks where a leg would be too short. All curves are cubic B-splines of the
/// samples, so the acceleration is continuous. The sharp transition is the foot strike: a pulse of
/// 0.12 s, then ringing. Foot poses are exact and legs follow by inverse kinematics, so a standing
/// foot never slips. A foot that stays behind lifts its heel before it swings, as in the trace.
/// Roll, yaw, ringing and pulse are movements of the frame above the hips; the pelvis does not make
/// them. `at` includes these movements; `pelvis` and `joints` do not.
class RexMotion final : public Motion {
  public:
    /// Returns a usage error if the legs cannot reach a step or, on level ground, a joint leaves
    /// its range. Steps up and down are checked for reach only: the heel lift is not modelled.
    [[nodiscard]] static Result<RexMotion> make(const RexPlan& plan,
                                                const RexGaitConfig& config,
                                                const GroundHeight& ground_z_m,
                                                std::uint64_t seed);

    [[nodiscard]] MotionState at(double time_s) const override;
    [[nodiscard]] double duration_s() const override { return duration_s_; }
    /// Returns the angles of `joints` and the sway of the frame. The feet of a REX drawn at
    /// base_link then stay in place, except for the vertical ringing of a few millimetres.
    [[nodiscard]] std::optional<RexJoints> rex_joints(double time_s) const override;

    /// Pose of base_link without sway, ringing and strike pulses, as the legs carry it.
    [[nodiscard]] Pose pelvis(double time_s) const;
    [[nodiscard]] FootState foot(Side side, double time_s) const;
    [[nodiscard]] LegAngles joints(Side side, double time_s) const;

    /// Time span of one step, with the level poses of base_link before and after the step.
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
        double heel_up_s = 0.0;  ///< time when the heel leaves the ground; the toes stay
        double start_s = 0.0;
        double end_s = 0.0;  ///< time when the toes land
        double heel_down_s = 0.0;
        double lift_rad = 0.0;  ///< angle of the sole about the toes
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

    std::vector<Body> bodies_;                  ///< in time order; the first one is a stand
    std::array<std::vector<Swing>, 2> swings_;  ///< swings in time order; first = stand
    std::vector<Strike> strikes_;               ///< in time order
    std::vector<Span> steps_;
    double duration_s_ = 0.0;
};

}  // namespace surefoot::sim
