// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "surefoot/sim/motion/rex_kinematics.hpp"

namespace surefoot::sim {

/// All moving joints of a REX. The camera is fixed to base_link. The legs hang from the pelvis.
/// The frame above the hips is flexible: it turns against the pelvis by a few degrees.
struct RexJoints {
    static constexpr std::size_t kCount = 15;

    /// Turn of the pelvis in base_link, Rz(yaw) Ry(pitch) Rx(roll).
    double frame_yaw_rad = 0.0;
    double frame_pitch_rad = 0.0;
    double frame_roll_rad = 0.0;
    LegAngles left;
    LegAngles right;

    /// Joint values in the order of kRexJointNames.
    [[nodiscard]] std::array<double, kCount> in_order() const noexcept;
};

/// Joint names of models/rex.yaml.
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
