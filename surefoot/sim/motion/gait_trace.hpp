// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace surefoot::sim {

/// Angles of the leg links in the sagittal plane about the pelvis' y axis (left). 0 = hanging
/// straight down; positive = backward. For the foot, positive = toes down.
struct LinkAngles {
    double upper_leg_rad = 0.0;
    double lower_leg_rad = 0.0;
    double foot_rad = 0.0;
};

struct GaitSample {
    LinkAngles left;
    LinkAngles right;
};

/// One forward step of the REX, simulated in V-REX (M. Lange, "Viability of Commercial Depth
/// Sensors for the REX Medical Exoskeleton", 2016): the right foot moves half a step, the left a
/// full step, then the right closes. Angles are relative to the upright pelvis. 64 samples at equal
/// intervals: 12.6 s at 5 Hz; through the kinematics they advance 0.51 m.
[[nodiscard]] std::span<const GaitSample> gait_trace() noexcept;

/// Link angle of a foot that stands flat: the constant offset between foot link and sole.
inline constexpr double kFlatFoot_rad = 0.0640978;

}  // namespace surefoot::sim
