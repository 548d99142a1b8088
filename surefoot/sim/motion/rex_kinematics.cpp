// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_kinematics.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Pose turned(const AngleAxisd& rotation) {
    Pose T;
    T.rotation = rotation;
    return T;
}
Pose lower(double down_m) {
    Pose T;
    T.translation_m = {0.0, 0.0, -down_m};
    return T;
}

Vector3d hip_body_m(Side side) {
    return {rex::kHip_x_m, sign_of(side) * rex::kHip_y_m, 0.0};
}

struct Range {
    const char* joint;
    double min_deg;
    double max_deg;
    double angle_rad;
};

}  // namespace

LegPoses leg_poses(Side side, const LegAngles& angles) {
    Pose T_body_hip;
    T_body_hip.translation_m = hip_body_m(side);
    T_body_hip.rotation = AngleAxisd(angles.hip_rotation_rad, Vector3d::UnitZ()) *
                          AngleAxisd(angles.hip_roll_rad, Vector3d::UnitX());
    LegPoses poses;
    poses.T_body_upper = T_body_hip * turned(AngleAxisd(angles.hip_pitch_rad, Vector3d::UnitY()));
    poses.T_body_lower = poses.T_body_upper * lower(rex::kUpperLeg_m) *
                         turned(AngleAxisd(angles.knee_rad, Vector3d::UnitY()));
    Pose T_ankle_sole;
    T_ankle_sole.rotation = AngleAxisd(angles.ankle_pitch_rad, Vector3d::UnitY()) *
                            AngleAxisd(angles.ankle_roll_rad, Vector3d::UnitX());
    T_ankle_sole.translation_m = T_ankle_sole.rotation * Vector3d(0.0, 0.0, -rex::kAnkleHeight_m);
    poses.T_body_sole = poses.T_body_lower * lower(rex::kLowerLeg_m) * T_ankle_sole;
    return poses;
}

Pose pelvis_to_sole(Side side, const LegAngles& angles) {
    return leg_poses(side, angles).T_body_sole;
}

std::optional<LegAngles> leg_angles(Side side, const Pose& T_body_sole) {
    const Vector3d ankle_body_m = T_body_sole * Vector3d(0.0, 0.0, rex::kAnkleHeight_m);
    // Position of the hip relative to the ankle, in the axes of the foot.
    const Vector3d hip = T_body_sole.rotation.conjugate() * (hip_body_m(side) - ankle_body_m);
    const double a = rex::kUpperLeg_m;
    const double b = rex::kLowerLeg_m;
    const double reach = hip.norm();
    if (reach > a + b || reach < std::abs(a - b) || hip.z() <= 0.0) return std::nullopt;

    LegAngles q;
    q.knee_rad = std::acos(std::clamp((reach * reach - a * a - b * b) / (2.0 * a * b), -1.0, 1.0));
    const double shank_to_reach =
        std::asin(std::clamp(a / reach * std::sin(q.knee_rad), -1.0, 1.0));
    q.ankle_roll_rad = std::atan2(hip.y(), hip.z());
    q.ankle_pitch_rad = -std::atan2(hip.x(), std::hypot(hip.y(), hip.z())) - shank_to_reach;
    const Eigen::Matrix3d R =
        (T_body_sole.rotation * AngleAxisd(-q.ankle_roll_rad, Vector3d::UnitX()) *
         AngleAxisd(-q.ankle_pitch_rad - q.knee_rad, Vector3d::UnitY()))
            .toRotationMatrix();
    q.hip_rotation_rad = std::atan2(-R(0, 1), R(1, 1));
    q.hip_roll_rad = std::atan2(R(2, 1), std::hypot(R(0, 1), R(1, 1)));
    q.hip_pitch_rad = std::atan2(-R(2, 0), R(2, 2));
    return q;
}

double hip_reach_m(double horizontal_m) noexcept {
    constexpr double kLeast_rad = 3.0 * kRadPerDeg;
    const double a = rex::kUpperLeg_m;
    const double b = rex::kLowerLeg_m;
    const double length_sq = a * a + b * b + 2.0 * a * b * std::cos(kLeast_rad);
    return std::sqrt(std::max(0.0, length_sq - horizontal_m * horizontal_m));
}

std::optional<std::string> joint_problem(Side side, const LegAngles& angles) {
    const Range ranges[] = {{"hip flexion", -15.0, 90.0, angles.hip_flexion_rad()},
                            {"hip abduction", -16.0, 20.0, angles.hip_abduction_rad(side)},
                            {"knee flexion", 0.0, 93.0, angles.knee_rad},
                            {"ankle dorsiflexion", -10.0, 20.0, angles.dorsiflexion_rad()},
                            {"ankle inversion", -9.0, 9.0, angles.ankle_roll_rad}};
    for (const Range& range : ranges) {
        const double angle_deg = range.angle_rad / kRadPerDeg;
        if (angle_deg >= range.min_deg && angle_deg <= range.max_deg) continue;
        return fmt::format("{} {} would be {:.1f} deg; the joint allows {:.0f} to {:.0f} deg",
                           kSideNames[static_cast<int>(side)],
                           range.joint,
                           angle_deg,
                           range.min_deg,
                           range.max_deg);
    }
    return std::nullopt;
}

}  // namespace surefoot::sim
