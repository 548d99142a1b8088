// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace surefoot::sim {

/// Links of a leg in the sagittal plane, turned about the pelvis' y axis (left): angle 0 hangs
/// straight down, a positive one points backward; of the foot, a positive one points the toes down.
struct LinkAngles {
    double upper_leg_rad = 0.0;
    double lower_leg_rad = 0.0;
    double foot_rad = 0.0;
};

struct GaitSample {
    LinkAngles left;
    LinkAngles right;
};

/// One step ahead of the REX as simulated in V-REX (after M. Lange, "Viability of Commercial Depth
/// Sensors for the REX Medical Exoskeleton", 2016): right half a step, left a whole one, right
/// closes. Angles against the pelvis, which stays upright in that record. 64 samples in equal
/// intervals; played at 5 Hz they take 12.6 s and, through the kinematics, go 0.51 m.
[[nodiscard]] std::span<const GaitSample> gait_trace() noexcept;

/// Angle of a foot that stands flat: a constant offset between foot link and sole.
inline constexpr double kFlatFoot_rad = 0.0640978;

}  // namespace surefoot::sim
