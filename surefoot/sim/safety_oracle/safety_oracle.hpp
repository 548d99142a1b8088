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

/// Why a movement is truly dangerous; what is named first matters most. Metres unless noted.
enum class Danger : std::uint8_t {
    unknown_command,   ///< the machine has no such movement, or its class is switched off
    unknown_pose,      ///< the pose is no number
    no_stance,         ///< the feet do not stand where they are now: one hangs, or at two heights
    not_level_here,    ///< the ground under the present feet is too steep [deg]
    no_ground,         ///< nothing under some part of a landing foot
    drop_off,          ///< a part of a landing foot over ground that is a drop
    edge_too_near,     ///< a drop beside a landing foot, inside the band (value: distance)
    step_up,           ///< ground under a landing foot higher than this class of movement allows
    step_down,         ///< lower
    tilt,              ///< the foot would stand too steep [deg]
    roughness,         ///< a patch of the sole too far from the plane of the foot
    obstacle_in_way,   ///< something in the way of a swinging foot (value: its height)
    body_hits,         ///< something solid in the space of the body (value: where it begins)
    overhang_too_low,  ///< the same, beginning higher than the hips
    disconnected,      ///< the ground of landing is cut off from the ground of standing
};
inline constexpr int kDangerCount = 15;
[[nodiscard]] const char* to_string(Danger danger) noexcept;

/// The worst place of one danger.
struct Finding {
    Danger danger = Danger::unknown_command;
    double value = 0.0;  ///< [m], or degrees for tilt and not_level_here
    double limit = 0.0;  ///< same unit
    Eigen::Vector3d where_m = Eigen::Vector3d::Zero();  ///< world
};

/// How far the question may move before the answer counts as borderline. ASSUMPTION: what a good
/// map and pose may be wrong by; the gate may be more careful than the truth there.
struct SafetyMargin {
    double position_m = 0.010;  ///< along, across, and of the height of the user
    double yaw_rad = 0.009;     ///< about 0.5 deg
    double limit_share = 0.10;  ///< every other limit this much stricter and looser
};

/// The truth about one command.
struct SafetyAnswer {
    bool safe = false;  ///< false unless every rule was checked and holds
    /// The answer stays the same within the margin.
    bool clear_cut = false;
    std::vector<Finding> dangers;  ///< one for each danger, the one that matters most first

    [[nodiscard]] bool has(Danger danger) const noexcept;
    /// One sentence for people.
    [[nodiscard]] std::string sentence() const;
};

/// Is it truly safe to give `command` (a joystick code) to a machine that stands at
/// `T_world_body`? From the geometry of the scene alone; an oracle for the step gate that shares
/// nothing with it but the machine's figures.
///
/// Only position and yaw of the pose matter, and its height to tell storeys apart: the feet stand
/// on what is highest below the ankles (not higher than the lower edge of the body above the
/// soles). The body is upright. Rules, all of them without any tolerance for noise:
/// - Stance: ground under the whole of both present feet, not steeper than the tilt limit, and the
///   feet at one height within the step limit. Its plane (median slope, mean height) goes on ahead;
///   heights are measured from it, so that a ramp under the machine is no step.
/// - Landing: at every 5 mm of both feet after the movement, ground within the step limits; the
///   plane fitted to it no steeper than the tilt limit; means of patches within the residual limit.
/// - Edge: no ground lower than the drop limit, and no void, within the drop band around them.
/// - Way: nothing higher than the swing clearance where a foot passes (or than the step up limit of
///   the class, if that is larger), foot margin included, nor hanging lower than the body's edge.
/// - Body: nothing solid where the box with its sway passes, from lower edge to height.
/// - The ground of landing is joined to that of standing without a jump over the swing clearance.
/// The way is straight and turns evenly. A movement of class stair, if the machine file enables
/// it, must place the whole foot like any other: the rules for treads are not here.
///
/// Precondition: machine.problem() == nullptr.
[[nodiscard]] SafetyAnswer judge(const Scene& scene,
                                 const Machine& machine,
                                 const Pose& T_world_body,
                                 int command,
                                 const SafetyMargin& margin = {});

/// Answers [pose * commands.size() + command]; the same for every executor.
[[nodiscard]] std::vector<SafetyAnswer> judge_all(const Scene& scene,
                                                  const Machine& machine,
                                                  std::span<const Pose> T_world_body,
                                                  std::span<const int> commands,
                                                  Executor& executor,
                                                  const SafetyMargin& margin = {});

/// A label as it is written to a file.
struct SafetyLabel {
    std::int64_t time_ns = 0;
    int command = 0;
    SafetyAnswer answer;
};

/// One line per label: time_s,command,safe,clear_cut,dangers,value,limit,x_m,y_m,z_m; dangers are
/// joined by '|', the figures are those of the first.
[[nodiscard]] std::string safety_csv(std::span<const SafetyLabel> labels);

}  // namespace surefoot::sim
