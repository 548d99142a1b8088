// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "surefoot/core/pose.hpp"

namespace surefoot::sim {

enum class Side : std::uint8_t { left, right };
inline constexpr const char* kSideNames[] = {"left", "right"};
[[nodiscard]] constexpr double sign_of(Side side) noexcept {
    return side == Side::left ? 1.0 : -1.0;
}

/// Dimensions of a REX leg (data sheet and collision model of the reference thesis, Lange 2016).
namespace rex {
inline constexpr double kUpperLeg_m = 0.430;
inline constexpr double kLowerLeg_m = 0.416;
inline constexpr double kAnkleHeight_m = 0.144;  ///< height of the ankle above the sole
inline constexpr double kToes_m = 0.240;         ///< distance ahead of the ankle: 0.366 - 0.126 m
/// Half of the pelvis width of 0.470 m. The ankle is straight below. The foot is centred 0.180 m
/// beside base_link and 0.190 m wide. Its inner edge is 0.150 m from the ankle.
inline constexpr double kHip_y_m = 0.235;
/// Distance of the ankles behind the hips in the stand of the gait trace. In the machine file the
/// ankles are below base_link (heels 0.126 m behind), so the hip axis is ahead of base_link.
inline constexpr double kHip_x_m = 0.0563;
/// Height of base_link above the soles in the stand of the trace, knees bent by 3.5 deg (0.990 m
/// with straight legs).
inline constexpr double kStand_m = 0.9877;
}  // namespace rex

/// Joint angles of a leg: each child link against its parent, about the parent's axes (x forward, y
/// left, z up), in the order of the chain. ASSUMPTION: hip rotation is play of the frame, because
/// the data sheet has none. A turn in place and the swaying pelvis need a few degrees of it.
struct LegAngles {
    double hip_rotation_rad = 0.0;  ///< about z
    double hip_roll_rad = 0.0;      ///< about x
    double hip_pitch_rad = 0.0;     ///< about y, positive = leg backward
    double knee_rad = 0.0;          ///< about y, positive = flexed
    double ankle_pitch_rad = 0.0;   ///< about y, positive = toes down
    double ankle_roll_rad = 0.0;    ///< about x

    [[nodiscard]] double hip_flexion_rad() const noexcept { return -hip_pitch_rad; }
    /// Positive = outward.
    [[nodiscard]] double hip_abduction_rad(Side side) const noexcept {
        return sign_of(side) * hip_roll_rad;
    }
    [[nodiscard]] double dorsiflexion_rad() const noexcept { return -ankle_pitch_rad; }
};

/// Poses of the links of a leg in base_link. Upper and lower leg extend from their origin (hip,
/// knee) along -z.
struct LegPoses {
    Pose T_body_upper;
    Pose T_body_lower;
    Pose T_body_sole;  ///< the point of the sole below the ankle: z up, x toward the toes
};
[[nodiscard]] LegPoses leg_poses(Side side, const LegAngles& angles);
[[nodiscard]] Pose pelvis_to_sole(Side side, const LegAngles& angles);

/// Joint angles that bring the sole to a pose in base_link; no value if the leg is too short or
/// would fold through itself. Closed form for a leg whose ankle axes meet (Kajita et al.,
/// "Introduction to Humanoid Robotics", 2014, section 2.5.2).
[[nodiscard]] std::optional<LegAngles> leg_angles(Side side, const Pose& T_body_sole);

/// Largest height of a hip above its ankle at the horizontal distance `horizontal_m`, with the knee
/// bent by at least 3 deg (standing: 3.5 deg).
[[nodiscard]] double hip_reach_m(double horizontal_m) noexcept;

/// Names the first joint outside the ranges of the machine's data sheet (machines/rex.yaml); no
/// value if all joints are inside.
[[nodiscard]] std::optional<std::string> joint_problem(Side side, const LegAngles& angles);

}  // namespace surefoot::sim
