// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_gait.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/assert.hpp"

namespace surefoot::sim {
namespace {

constexpr double kRing_s = 1.2;  ///< duration of the ringing after a foot strike
constexpr double kHanging_rad =
    3.0 * std::numbers::pi / 180.0;  ///< ASSUMPTION: a swinging foot's toes hang down by this angle
constexpr double kPulse_s = 0.12;    ///< ASSUMPTION: duration of a foot strike

/// u^n and its derivatives by time, for u that rises from 0 to 1 within `length_s`.
Jet power(double u, double length_s, int n) {
    return {std::pow(u, n),
            n * std::pow(u, n - 1) / length_s,
            n * (n - 1) * std::pow(u, n - 2) / (length_s * length_s)};
}

/// (1 - u)^n and its derivatives by time.
Jet falling_power(double u, double length_s, int n) {
    Jet jet = power(1.0 - u, length_s, n);
    jet.rate = -jet.rate;
    return jet;
}

/// Envelope u^3 (1-u)^9, scaled to 1 at u = 1/4. Its value and its first two derivatives are 0 at
/// both ends.
Jet ring_window(double t_s) {
    constexpr double kPeak = (1.0 / 64.0) * (19683.0 / 262144.0);  // (1/4)^3 (3/4)^9
    const double u = t_s / kRing_s;
    return (1.0 / kPeak) * (power(u, kRing_s, 3) * falling_power(u, kRing_s, 9));
}

/// A dip whose upward acceleration is 1 in the middle: -u^3 (1-u)^3 times (8/3) T^2, with T =
/// `kPulse_s`.
Jet strike_dip(double t_s) {
    const double u = t_s / kPulse_s;
    return (-8.0 / 3.0 * kPulse_s * kPulse_s) *
           (power(u, kPulse_s, 3) * falling_power(u, kPulse_s, 3));
}

/// Pose of a sole that is turned about its toes, with the heel up.
Pose about_toes(double lift_rad) {
    const Eigen::Vector3d toes_m(rex::kToes_m, 0.0, 0.0);
    Pose T;
    T.rotation = Eigen::AngleAxisd(lift_rad, Eigen::Vector3d::UnitY());
    T.translation_m = toes_m - T.rotation * toes_m;
    return T;
}

}  // namespace

/// Returns the tilt of a foot as a share of its full tilt `lift_rad`. The heel rises before the
/// swing and falls during it, or rises during the swing and falls after it.
double RexMotion::lifted(const Swing& swing, double time_s, double share) {
    if (swing.heel_up_s < swing.start_s) {
        if (time_s >= swing.start_s) return 1.0 - share;
        return eased((time_s - swing.heel_up_s) / (swing.start_s - swing.heel_up_s));
    }
    if (swing.heel_down_s <= swing.end_s) return 0.0;
    if (time_s <= swing.end_s) return share;
    return 1.0 - eased((time_s - swing.end_s) / (swing.heel_down_s - swing.end_s));
}

const RexMotion::Body& RexMotion::body(double time_s) const {
    const auto next = std::upper_bound(
        bodies_.begin() + 1, bodies_.end(), time_s, [](double t_s, const Body& candidate) {
            return t_s < candidate.start_s;
        });
    return *(next - 1);
}

MotionState RexMotion::at(double time_s) const {
    const Body& now = body(time_s);
    std::array<Jet, 3> position{
        now.position_m[0].at(time_s), now.position_m[1].at(time_s), now.position_m[2].at(time_s)};
    std::array<Jet, 3> angles{now.sway_roll_rad.at(time_s),
                              now.pitch_rad.at(time_s),
                              now.yaw_rad.at(time_s) + now.sway_yaw_rad.at(time_s)};
    const auto first = std::lower_bound(
        strikes_.begin(), strikes_.end(), time_s - kRing_s, [](const Strike& strike, double t_s) {
            return strike.time_s < t_s;
        });
    for (auto strike = first; strike != strikes_.end() && strike->time_s <= time_s; ++strike) {
        const double since_s = time_s - strike->time_s;
        const Jet ring = ring_window(since_s) * oscillation(1.0, strike->omega_rad_s, 0.0, since_s);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            position[axis] = position[axis] + strike->ring_m[axis] * ring;
            angles[axis] = angles[axis] + strike->ring_rad[axis] * ring;
        }
        if (since_s < kPulse_s)
            position[2] = position[2] + strike->pulse_m_s2 * strike_dip(since_s);
    }
    return motion_state(position, angles);
}

Pose RexMotion::pelvis(double time_s) const {
    const Body& now = body(time_s);
    return motion_state({now.position_m[0].at(time_s),
                         now.position_m[1].at(time_s),
                         now.position_m[2].at(time_s)},
                        {Jet{}, now.pitch_rad.at(time_s), now.yaw_rad.at(time_s)})
        .T_world_body;
}

FootState RexMotion::foot(Side side, double time_s) const {
    const std::vector<Swing>& swings = swings_[static_cast<std::size_t>(side)];
    const auto next = std::upper_bound(
        swings.begin() + 1, swings.end(), time_s, [](double t_s, const Swing& candidate) {
            return t_s < candidate.heel_up_s;
        });
    const Swing& swing = *(next - 1);
    FootState state;
    state.carries = time_s <= swing.heel_up_s || time_s >= swing.heel_down_s;
    const double u = std::clamp(
        (time_s - swing.start_s) / std::max(swing.end_s - swing.start_s, 1e-9), 0.0, 1.0);
    const double share = eased(u);
    Eigen::Vector3d at_m = swing.from_m + share * (swing.to_m - swing.from_m);
    // On a step up the foot rises in the first half of the swing, on a step down it sinks in the
    // second half, so that it clears the edge.
    const double rise_m = swing.to_m.z() - swing.from_m.z();
    at_m.z() = swing.from_m.z() + rise_m * eased(rise_m > 0.0 ? 2.0 * u : 2.0 * u - 1.0);
    const double yaw_rad = swing.from_yaw_rad + share * (swing.to_yaw_rad - swing.from_yaw_rad);
    const Eigen::Quaterniond flat(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    // During the swing the toes also hang down a little, so that the ankle need not bend so far.
    const double bump = 64.0 * std::pow(u * (1.0 - u), 3);
    at_m.z() += swing.clearance_m * bump;
    const double tilt_rad = swing.lift_rad * lifted(swing, time_s, share) + kHanging_rad * bump;
    state.T_world_sole = Pose{flat, at_m} * about_toes(tilt_rad);
    return state;
}

std::optional<LegAngles> RexMotion::leg(Side side, double time_s) const {
    return leg_angles(side, pelvis(time_s).inverse() * foot(side, time_s).T_world_sole);
}

LegAngles RexMotion::joints(Side side, double time_s) const {
    const auto angles = leg(side, time_s);
    SUREFOOT_ASSERT(angles.has_value());  // `make` has checked the reach at twice the sample rate
    return *angles;
}

std::optional<RexJoints> RexMotion::rex_joints(double time_s) const {
    const auto left = leg(Side::left, time_s);
    const auto right = leg(Side::right, time_s);
    if (!left || !right) return std::nullopt;
    const Eigen::Matrix3d R_body_pelvis =
        (at(time_s).T_world_body.rotation.conjugate() * pelvis(time_s).rotation).toRotationMatrix();
    RexJoints joints;
    joints.frame_yaw_rad = std::atan2(R_body_pelvis(1, 0), R_body_pelvis(0, 0));
    joints.frame_pitch_rad = std::asin(std::clamp(-R_body_pelvis(2, 0), -1.0, 1.0));
    joints.frame_roll_rad = std::atan2(R_body_pelvis(2, 1), R_body_pelvis(2, 2));
    joints.left = *left;
    joints.right = *right;
    return joints;
}

}  // namespace surefoot::sim
