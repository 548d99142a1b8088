// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/knock.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "surefoot/core/angles.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// A value that rises from 0 to 1 with continuous acceleration: 10 s^3 - 15 s^4 + 6 s^5, with
/// derivatives by s.
struct Blend {
    double value;
    double first;
    double second;
};

Blend blend(double s) {
    s = std::clamp(s, 0.0, 1.0);
    const double s2 = s * s;
    return {s * s2 * (10.0 - 15.0 * s + 6.0 * s2),
            30.0 * s2 * (1.0 - s) * (1.0 - s),
            60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)};
}

}  // namespace

void KnockConfig::describe(ConfigVisitor& visitor) {
    visitor.number("at_s", at_s, 0.0, 1e5, "time of the knock after the first frame");
    visitor.number(
        "roll_deg", roll_deg, -45.0, 45.0, "roll of the camera on its mount that the knock causes");
    visitor.number("pitch_deg",
                   pitch_deg,
                   -45.0,
                   45.0,
                   "pitch of the camera on its mount that the knock causes; positive = down");
    visitor.number(
        "yaw_deg", yaw_deg, -45.0, 45.0, "yaw of the camera on its mount that the knock causes");
}

KnockedMotion::KnockedMotion(std::shared_ptr<const Motion> machine,
                             const KnockConfig& knock,
                             const Vector3d& left_camera_body_m)
    : machine_(std::move(machine)), at_s_(knock.at_s), pivot_m_(left_camera_body_m) {
    const Eigen::AngleAxisd turn(
        Eigen::AngleAxisd(knock.yaw_deg * kRadPerDeg, Vector3d::UnitZ()) *
        Eigen::AngleAxisd(knock.pitch_deg * kRadPerDeg, Vector3d::UnitY()) *
        Eigen::AngleAxisd(knock.roll_deg * kRadPerDeg, Vector3d::UnitX()));
    angle_rad_ = turn.angle();
    axis_ = turn.axis();
}

MotionState KnockedMotion::at(double time_s) const {
    MotionState state = machine_->at(time_s);
    const Blend turned = blend((time_s - at_s_) / kKnockDuration_s);
    if (turned.value == 0.0) return state;
    const double rate_rad_s = angle_rad_ * turned.first / kKnockDuration_s;
    const double change_rad_s2 = angle_rad_ * turned.second / (kKnockDuration_s * kKnockDuration_s);
    const Eigen::Quaterniond knock(Eigen::AngleAxisd(angle_rad_ * turned.value, axis_));
    // Position of base_link's origin after the knock, in the machine's base_link, with derivatives.
    const Vector3d arm_m = knock * pivot_m_;
    const Vector3d r_m = pivot_m_ - arm_m;
    const Vector3d r_m_s = -rate_rad_s * axis_.cross(arm_m);
    const Vector3d r_m_s2 = -change_rad_s2 * axis_.cross(arm_m) -
                            rate_rad_s * rate_rad_s * axis_.cross(axis_.cross(arm_m));

    const Eigen::Quaterniond R = state.T_world_body.rotation;
    const Vector3d w = state.angular_velocity_body_rad_s;
    state.T_world_body.translation_m += R * r_m;
    state.velocity_world_m_s += R * (w.cross(r_m) + r_m_s);
    state.acceleration_world_m_s2 += R * (state.angular_acceleration_body_rad_s2.cross(r_m) +
                                          w.cross(w.cross(r_m)) + 2.0 * w.cross(r_m_s) + r_m_s2);
    state.T_world_body.rotation = (R * knock).normalized();
    const Vector3d w_knocked = knock.conjugate() * w;
    state.angular_velocity_body_rad_s = w_knocked + rate_rad_s * axis_;
    state.angular_acceleration_body_rad_s2 =
        knock.conjugate() * state.angular_acceleration_body_rad_s2 -
        rate_rad_s * axis_.cross(w_knocked) + change_rad_s2 * axis_;
    return state;
}

}  // namespace surefoot::sim
