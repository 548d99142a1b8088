// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/sim/safety_oracle/safety_figures.hpp"
#include "surefoot/sim/safety_oracle/safety_rules.hpp"
#include "surefoot/sim/safety_oracle/swept_box.hpp"
#include "surefoot/sim/scenes/ground_field.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using rules::Figures;

constexpr std::array<const char*, kDangerCount> kDangerNames{"unknown_command",
                                                             "unknown_pose",
                                                             "no_stance",
                                                             "not_level_here",
                                                             "no_ground",
                                                             "drop_off",
                                                             "edge_too_near",
                                                             "step_up",
                                                             "step_down",
                                                             "tread_support",
                                                             "tread_overhang",
                                                             "tilt",
                                                             "roughness",
                                                             "obstacle_in_way",
                                                             "body_hits",
                                                             "overhang_too_low",
                                                             "disconnected"};

SafetyAnswer refused(Danger danger, const Eigen::Vector3d& where_m) {
    SafetyAnswer answer;
    answer.clear_cut = true;
    answer.dangers.push_back({danger, 0.0, 0.0, where_m});
    return answer;
}

/// Returns the stance before the movement. It is unknown if the ground differs from the height of
/// the soles by more than the body's lower edge.
rules::Stance stance_here(const Scene& scene,
                          const Figures& figures,
                          const PlanarPose& T_world_field,
                          double sole_z_m) {
    Rect feet = figures.feet[0];
    feet.min_m = feet.min_m.cwiseMin(figures.feet[1].min_m);
    feet.max_m = feet.max_m.cwiseMax(figures.feet[1].max_m);
    const GroundField field(scene,
                            T_world_field,
                            grown(feet, GroundField::kSpacing_m),
                            {sole_z_m, Vector2d::Zero()},
                            figures.reach_m());
    rules::Stance stance = rules::stand(field, figures, {});
    if (!(std::abs(stance.plane.height_m - sole_z_m) <= figures.lower_edge_m)) stance.known = false;
    return stance;
}

/// Returns true if the answer is the same at seven poses: in the middle and at the ends of the
/// margin along x, y and yaw. The limits are changed by the margin too: stricter for a safe
/// movement, looser for an unsafe one.
bool holds_around(const GroundField& field,
                  const std::vector<char>& reached,
                  const Figures& figures,
                  const SafetyMargin& margin,
                  bool safe) {
    const double p_m = margin.position_m;
    const std::array<PlanarPose, 7> poses{PlanarPose{},
                                          PlanarPose::of(p_m, 0.0, 0.0),
                                          PlanarPose::of(-p_m, 0.0, 0.0),
                                          PlanarPose::of(0.0, p_m, 0.0),
                                          PlanarPose::of(0.0, -p_m, 0.0),
                                          PlanarPose::of(0.0, 0.0, margin.yaw_rad),
                                          PlanarPose::of(0.0, 0.0, -margin.yaw_rad)};
    // A movement that is safe under stricter limits is also safe under looser ones.
    const Figures moved = safe ? rules::stricter(figures, margin.limit_share, p_m)
                               : rules::stricter(figures, -margin.limit_share, -p_m);
    return std::all_of(poses.begin(), poses.end(), [&](const PlanarPose& T_field_body) {
        return rules::dangers_at(field, reached, moved, T_field_body).empty() == safe;
    });
}

std::string describe(const Finding& f) {
    const std::string at =
        fmt::format("at ({:.2f}, {:.2f}, {:.2f})", f.where_m.x(), f.where_m.y(), f.where_m.z());
    const auto against = [&](const char* what) {
        return fmt::format("{} {:.3f} m {}, limit {:.3f} m", what, f.value, at, f.limit);
    };
    switch (f.danger) {
        case Danger::unknown_command:
            return "the machine has no such movement, or its class is disabled";
        case Danger::unknown_pose: return "a number in the pose of the machine is not finite";
        case Danger::no_stance:
            return f.limit > 0.0 ? against("the feet stand at heights that differ by")
                                 : "the feet do not stand on ground " + at;
        case Danger::not_level_here:
            return fmt::format(
                "the ground here tilts by {:.1f} deg, limit {:.1f} deg", f.value, f.limit);
        case Danger::no_ground: return "there is no ground under a landing foot " + at;
        case Danger::drop_off: return against("a landing foot hangs over a drop of");
        case Danger::edge_too_near:
            return against("a drop lies beside a landing foot at a distance of");
        case Danger::step_up: return against("a landing foot meets a step up of");
        case Danger::step_down: return against("a landing foot meets a step down of");
        case Danger::tread_support: return against("the tread under a landing foot carries only");
        case Danger::tread_overhang: return against("a landing foot reaches over its tread by");
        case Danger::tilt:
            return fmt::format("a landing foot would tilt by {:.1f} deg {}, limit {:.1f} deg",
                               f.value,
                               at,
                               f.limit);
        case Danger::roughness: return against("the ground under a landing foot is uneven by");
        case Danger::obstacle_in_way:
            return against(
                "an obstacle in the path of a foot has its top or underside at a height of");
        case Danger::body_hits:
            return against("the body hits an object that begins at a height of");
        case Danger::overhang_too_low:
            return against("an object above the hips begins at a height of");
        case Danger::disconnected:
            return "the ground under a landing foot is not connected to the ground under the "
                   "standing feet " +
                   at;
    }
    return "unknown danger";
}

}  // namespace

const char* to_string(Danger danger) noexcept {
    return kDangerNames[static_cast<std::size_t>(danger)];
}

bool SafetyAnswer::has(Danger danger) const noexcept {
    return std::any_of(
        dangers.begin(), dangers.end(), [&](const Finding& f) { return f.danger == danger; });
}

std::string SafetyAnswer::sentence() const {
    const char* borderline = clear_cut ? "" : " (borderline)";
    if (safe) return fmt::format("safe{}", borderline);
    std::string text = fmt::format("not safe{}", borderline);
    for (const Finding& finding : dangers)
        text += fmt::format("{}{}", &finding == dangers.data() ? ": " : "; ", describe(finding));
    return text;
}

SafetyAnswer judge(const Scene& scene,
                   const Machine& machine,
                   const Pose& T_world_body,
                   int command,
                   const SafetyMargin& margin) {
    SUREFOOT_ASSERT(machine.problem() == nullptr);
    if (!T_world_body.all_finite()) return refused(Danger::unknown_pose, Eigen::Vector3d::Zero());
    const Eigen::Vector3d& here_m = T_world_body.translation_m;
    const Movement* movement = rules::movement_of(machine, command);
    if (movement == nullptr) return refused(Danger::unknown_command, here_m);

    const Figures figures = rules::figures_of(machine, *movement);
    const PlanarPose T_world_field = PlanarPose::of(here_m.x(), here_m.y(), yaw_rad(T_world_body));
    const double sole_z_m = here_m.z() - figures.hips_m;
    const rules::Stance stance = stance_here(scene, figures, T_world_field, sole_z_m);
    if (!stance.known) return refused(Danger::no_stance, {here_m.x(), here_m.y(), sole_z_m});

    const Figures wide = rules::stricter(figures, margin.limit_share, margin.position_m);
    // A turn by an angle a moves every corner of the region by at most kReach_m * a.
    constexpr double kReach_m = 1.0;
    const double slack_m =
        margin.position_m + kReach_m * margin.yaw_rad + 2.0 * GroundField::kSpacing_m;
    const GroundField field(
        scene, T_world_field, rules::region_of(wide, slack_m), stance.plane, wide.reach_m());
    const auto reached = field.reached_from(
        {field.range_of(figures.feet[0]), field.range_of(figures.feet[1])}, figures.clearance_m);

    SafetyAnswer answer;
    answer.dangers = rules::dangers_at(field, reached, figures, {});
    answer.safe = answer.dangers.empty();
    answer.clear_cut = holds_around(field, reached, figures, margin, answer.safe);
    return answer;
}

std::vector<SafetyAnswer> judge_all(const Scene& scene,
                                    const Machine& machine,
                                    std::span<const Pose> T_world_body,
                                    std::span<const int> commands,
                                    Executor& executor,
                                    const SafetyMargin& margin) {
    std::vector<SafetyAnswer> answers(T_world_body.size() * commands.size());
    executor.parallel_for(static_cast<int>(answers.size()), [&](int index) {
        const auto k = static_cast<std::size_t>(index);
        answers[k] = judge(scene,
                           machine,
                           T_world_body[k / commands.size()],
                           commands[k % commands.size()],
                           margin);
    });
    return answers;
}

std::string safety_csv(std::span<const SafetyLabel> labels) {
    std::string csv = "time_s,command,safe,clear_cut,dangers,value,limit,x_m,y_m,z_m\n";
    for (const SafetyLabel& label : labels) {
        std::string names;
        for (const Finding& f : label.answer.dangers)
            names += fmt::format("{}{}", names.empty() ? "" : "|", to_string(f.danger));
        csv += fmt::format("{}.{:09},{},{},{},{}",
                           label.time_ns / 1'000'000'000,
                           label.time_ns % 1'000'000'000,
                           label.command,
                           label.answer.safe ? 1 : 0,
                           label.answer.clear_cut ? 1 : 0,
                           names);
        if (label.answer.dangers.empty()) {
            csv += ",,,,,\n";
            continue;
        }
        const Finding& f = label.answer.dangers.front();
        csv += fmt::format(",{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n",
                           f.value,
                           f.limit,
                           f.where_m.x(),
                           f.where_m.y(),
                           f.where_m.z());
    }
    return csv;
}

}  // namespace surefoot::sim
