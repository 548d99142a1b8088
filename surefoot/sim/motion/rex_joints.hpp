// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "surefoot/sim/motion/rex_kinematics.hpp"

namespace surefoot::sim {

/// All that moves in a REX. Base_link is where the camera is mounted, and the frame above the hips
/// gives way: it turns against the pelvis, from which the legs hang, by a few degrees.
struct RexJoints {
    static constexpr std::size_t kCount = 15;

    /// Of the pelvis in base_link, Rz(yaw) Ry(pitch) Rx(roll).
    double frame_yaw_rad = 0.0;
    double frame_pitch_rad = 0.0;
    double frame_roll_rad = 0.0;
    LegAngles left;
    LegAngles right;

    /// In the order of kRexJointNames.
    [[nodiscard]] std::array<double, kCount> in_order() const noexcept;
};

/// As models/rex.yaml calls them.
inline constexpr std::array<std::string_view, RexJoints::kCount> kRexJointNames{
    "frame_yaw",
    "frame_pitch",
    "frame_roll",
    "left_hip_rotation",
    "left_hip_abduction",
    "pelvis_to_left_upperleg",
    "left_upperleg_to_left_lowerleg",
    "left_lowerleg_to_left_foot",
    "left_ankle_inversion",
    "right_hip_rotation",
    "right_hip_abduction",
    "pelvis_to_right_upperleg",
    "right_upperleg_to_right_lowerleg",
    "right_lowerleg_to_right_foot",
    "right_ankle_inversion"};

}  // namespace surefoot::sim
