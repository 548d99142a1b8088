// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::sim {

/// Reasons why a movement is dangerous, most important first. Values are in metres unless noted.
enum class Danger : std::uint8_t {
    unknown_command,   ///< the machine has no such movement, or its class is disabled
    unknown_pose,      ///< a number of the pose is not finite
    no_stance,         ///< a standing foot lacks ground, or the feet's heights differ too much
    not_level_here,    ///< the ground under the standing feet is too steep [deg]
    no_ground,         ///< some part of a landing foot has no ground
    drop_off,          ///< a part of a landing foot lies over a drop
    edge_too_near,     ///< a drop is inside the drop band of a landing foot (value: distance)
    step_up,           ///< ground under a landing foot is higher than this movement class allows
    step_down,         ///< ground under a landing foot is lower than this movement class allows
    tread_support,     ///< class stair: too little of a landing foot rests on its tread
    tread_overhang,    ///< class stair: an end of a landing foot reaches too far over the nosing
    tilt,              ///< a landing foot would tilt too steeply [deg]
    roughness,         ///< ground under a patch of the sole is too far from the fitted plane
    obstacle_in_way,   ///< an object in the path of a foot (value: height of top or underside)
    body_hits,         ///< a solid in the space of the body (value: height where it begins)
    overhang_too_low,  ///< like body_hits, but the underside is above the hips
    disconnected,      ///< the landing ground is not connected to the ground under the feet
};
inline constexpr int kDangerCount = 17;
[[nodiscard]] const char* to_string(Danger danger) noexcept;

/// The worst point of one danger.
struct Finding {
    Danger danger = Danger::unknown_command;
    double value = 0.0;  ///< [m], or degrees for tilt and not_level_here
    double limit = 0.0;  ///< limit in the unit of the value
    Eigen::Vector3d where_m = Eigen::Vector3d::Zero();  ///< position in the world
};

/// Changes of pose and limits that a clear-cut answer must survive. ASSUMPTION: errors of a good
/// map and pose; within this margin the gate may be more careful than the truth.
struct SafetyMargin {
    double position_m = 0.010;  ///< shift along and across, and change of the height of the user
    double yaw_rad = 0.009;     ///< about 0.5 deg
    double limit_share = 0.10;  ///< share by which all other limits become stricter or looser
};

/// The truth about one command.
struct SafetyAnswer {
    bool safe = false;  ///< false unless every rule was checked and holds
    /// The answer stays the same within the margin.
    bool clear_cut = false;
    std::vector<Finding> dangers;  ///< one for each danger, most important first

    [[nodiscard]] bool has(Danger danger) const noexcept;
    /// Describes the answer in one sentence.
    [[nodiscard]] std::string sentence() const;
};

/// Judges from the scene geometry alone whether `command` (a joystick code) is truly safe for a
/// machine that stands at `T_world_body`. This oracle tests the step gate; the two share only the
/// machine's dimensions and limits.
///
/// Only position and yaw of the pose matter; its height tells storeys apart. The feet stand on the
/// highest surface that is not above the lower edge of the body. The body is upright. Rules, all
/// without any tolerance for noise:
/// - Stance: ground lies under the whole of both standing feet, not steeper than the tilt limit,
///   and the feet are at one height within the step limit. Their plane (median slope, mean height)
///   continues ahead. Heights are measured from it, so that a ramp under the machine is not a step.
/// - Landing: every 5 mm under both feet after the movement, the ground is within the step limits.
///   The fitted plane is within the tilt limit, the means of patches are within the residual limit.
/// - Edge: the drop band around the landed feet has no void and no drop above the drop limit.
/// - Way: nothing in the path of a foot, with its margin, is higher than the swing clearance (or
///   the step-up limit of the class, if larger) or hangs lower than the body's edge.
/// - Body: no solid is in the path of a part of the body, widened by the sway.
/// - The landing ground is joined to the standing ground without a jump above the limit of "Way".
/// The path is straight and the turn is even.
///
/// A movement of class stair, if the machine file enables it, goes from tread to tread:
/// - The ankle of every foot, before and after, stands on its tread. The tread carries at least
///   `tread_share` of the foot, and neither end reaches over by more than `tread_overhang`. The
///   level of a tread is the median height under the ankle. It ends where a part across the foot
///   lies more than the drop limit lower. The carried part keeps the limits of tilt and patches.
/// - Both feet land at one level, at most one riser (step limits of the class) from the stance.
/// - Nothing is higher than the swing clearance above the higher tread in the path of a foot, or
///   above its own tread within the margin of a landed foot: a riser before the toes, an object.
/// - Around the landed foot nothing lies deeper than the next tread. Beside the carried part, even
///   this is too deep: the flight ends there.
/// - The body rises before it moves up, and sinks after it has moved down (ASSUMPTION).
///
/// Precondition: machine.problem() == nullptr.
[[nodiscard]] SafetyAnswer judge(const Scene& scene,
                                 const Machine& machine,
                                 const Pose& T_world_body,
                                 int command,
                                 const SafetyMargin& margin = {});

/// Judges all commands at the first pose, then at the next. The executor changes no answer.
[[nodiscard]] std::vector<SafetyAnswer> judge_all(const Scene& scene,
                                                  const Machine& machine,
                                                  std::span<const Pose> T_world_body,
                                                  std::span<const int> commands,
                                                  Executor& executor,
                                                  const SafetyMargin& margin = {});

/// The answer for one command at one time: a line of `safety_csv`.
struct SafetyLabel {
    std::int64_t time_ns = 0;
    int command = 0;
    SafetyAnswer answer;
};

/// One line per label: time_s,command,safe,clear_cut,dangers,value,limit,x_m,y_m,z_m. Dangers are
/// joined by '|'; value, limit and position belong to the first danger.
[[nodiscard]] std::string safety_csv(std::span<const SafetyLabel> labels);

}  // namespace surefoot::sim
