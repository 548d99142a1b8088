// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/rex_joints.hpp"

namespace surefoot::sim {

std::array<double, RexJoints::kCount> RexJoints::in_order() const noexcept {
    return {frame_yaw_rad,
            frame_pitch_rad,
            frame_roll_rad,
            left.hip_rotation_rad,
            left.hip_roll_rad,
            left.hip_pitch_rad,
            left.knee_rad,
            left.ankle_pitch_rad,
            left.ankle_roll_rad,
            right.hip_rotation_rad,
            right.hip_roll_rad,
            right.hip_pitch_rad,
            right.knee_rad,
            right.ankle_pitch_rad,
            right.ankle_roll_rad};
}

}  // namespace surefoot::sim
