// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_motion.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "surefoot/core/angles.hpp"
#include "surefoot/sim/motion/motion_scripts.hpp"
#include "surefoot/sim/motion/rex_kinematics.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::sim {
namespace {

constexpr int kMaxWaypoints = 1000;
constexpr double kReach_m = 100.0;

enum class Script : std::uint8_t {
    approach,
    turn_round,
    back_to_table,
    sidestep_through_door,
    descend_backwards,
    pivot_and_reverse
};
constexpr const char* kScriptNames[] = {"approach",
                                        "turn_round",
                                        "back_to_table",
                                        "sidestep_through_door",
                                        "descend_backwards",
                                        "pivot_and_reverse"};

/// Keys that every motion has.
struct MotionModelSpec {
    MotionModel motion_model = MotionModel::trolley;
    double speed_m_s = 0.0;
    double height_m = 0.0;
    void describe(ConfigVisitor& visitor) {
        visitor.enumeration(
            "motion_model", motion_model, kMotionModelNames, "motion model of the camera");
        visitor.number("speed_m_s",
                       speed_m_s,
                       0.0,
                       2.0,
                       "speed of the motion; 0 = default of the motion model");
        visitor.number("height_m",
                       height_m,
                       0.0,
                       3.0,
                       "height of base_link above the ground if the camera is hand-held; 0 = "
                       "default of the motion model");
    }
};

struct WaypointSpec {
    double x_m = kRequired;
    double y_m = kRequired;
    double yaw_deg = 0.0;
    double pause_s = 0.0;
    double ground_z_m = 0.0;
    Move move = Move::automatic;
    void describe(ConfigVisitor& visitor) {
        visitor.number("x_m", x_m, -kReach_m, kReach_m, "position of the waypoint along x (ahead)");
        visitor.number("y_m", y_m, -kReach_m, kReach_m, "position of the waypoint along y (left)");
        visitor.number("yaw_deg",
                       yaw_deg,
                       -3600.0,
                       3600.0,
                       "angle of base_link at the waypoint: 0 = along +x, 90 = along +y");
        visitor.number("pause_s", pause_s, 0.0, 600.0, "waiting time at the waypoint");
        visitor.number(
            "ground_z_m", ground_z_m, -kReach_m, kReach_m, "height of the ground at the waypoint");
        visitor.enumeration(
            "move", move, kMoveNames, "how a walking machine moves to the waypoint");
    }
};

/// Keys of one script; `script` decides which keys are valid.
struct ScriptSpec {
    MotionModelSpec carried;
    int script = kRequiredChoice;
    double distance_m = kRequired;
    double turn_deg = kRequired;
    double table_x_m = kRequired;
    double left_m = kRequired;
    double door_x_m = kRequired;
    double door_y_m = kRequired;
    double beyond_m = kRequired;
    double riser_m = kRequired;
    int steps_ahead = 0;

    void describe(ConfigVisitor& visitor) {
        carried.describe(visitor);
        visitor.choice("script", script, kScriptNames, "name of the motion script");
        if (script != kRequiredChoice) describe_script(visitor);
    }
    [[nodiscard]] std::optional<std::string> problem() const;
    [[nodiscard]] MotionScript made() const;

  private:
    void describe_script(ConfigVisitor& visitor);
};

void ScriptSpec::describe_script(ConfigVisitor& visitor) {
    switch (static_cast<Script>(script)) {
        case Script::approach:
        case Script::pivot_and_reverse:
            visitor.number("distance_m", distance_m, 0.1, kReach_m, "length of the path");
            return;
        case Script::turn_round:
            visitor.number("turn_deg",
                           turn_deg,
                           -360.0,
                           360.0,
                           "angle of the turn, positive to the left; afterwards the machine turns "
                           "back by the same angle");
            return;
        case Script::back_to_table:
            visitor.number(
                "table_x_m", table_x_m, 0.5, kReach_m, "x of the near border of the table");
            visitor.number("left_m",
                           left_m,
                           0.5,
                           kReach_m,
                           "distance to the table at which the machine turns round");
            return;
        case Script::sidestep_through_door:
            visitor.number(
                "door_x_m", door_x_m, 0.6, kReach_m, "x of the middle of the wall with the door");
            visitor.number(
                "door_y_m", door_y_m, -kReach_m, kReach_m, "y of the middle of the door opening");
            visitor.number("beyond_m",
                           beyond_m,
                           0.0,
                           kReach_m,
                           "distance behind the wall at which the path ends");
            return;
        case Script::descend_backwards:
            visitor.integer("steps_ahead",
                            steps_ahead,
                            1,
                            100,
                            "number of steps ahead before the machine turns round");
            visitor.number(
                "riser_m", riser_m, 0.0, 0.2, "height of each step of the descending flight");
            return;
    }
}

std::optional<std::string> ScriptSpec::problem() const {
    const auto which = static_cast<Script>(script);
    if (which == Script::back_to_table && left_m > table_x_m) {
        return fmt::format(
            "left_m {} must be at most table_x_m {}, because the machine starts at x = 0 m",
            left_m,
            table_x_m);
    }
    if (which != Script::descend_backwards) return std::nullopt;
    if (steps_ahead < 1) return "key 'steps_ahead' is missing";
    if (carried.motion_model == MotionModel::rex) return std::nullopt;
    return fmt::format(
        "script descend_backwards needs a walking machine: motion_model must be rex, not {}",
        kMotionModelNames[static_cast<int>(carried.motion_model)]);
}

MotionScript ScriptSpec::made() const {
    switch (static_cast<Script>(script)) {
        case Script::approach: return approach_script(carried.motion_model, distance_m);
        case Script::turn_round:
            return turn_round_script(carried.motion_model, turn_deg * kRadPerDeg);
        case Script::back_to_table:
            return back_to_table_script(carried.motion_model, table_x_m, left_m);
        case Script::sidestep_through_door:
            return sidestep_through_door_script(carried.motion_model, door_x_m, door_y_m, beyond_m);
        case Script::descend_backwards: return descend_backwards_script(steps_ahead, riser_m);
        case Script::pivot_and_reverse:
            return pivot_and_reverse_script(carried.motion_model, distance_m);
    }
    return {};
}

MotionScript read_script(SceneReader& reader, const SceneNode& group) {
    ScriptSpec spec;
    reader.read(group, spec);
    if (reader.error()) return {};
    if (const auto problem = spec.problem()) {
        reader.fail(group, *problem);
        return {};
    }
    MotionScript script = spec.made();
    script.speed_m_s = spec.carried.speed_m_s;
    script.height_m = spec.carried.height_m;
    return script;
}

MotionScript read_waypoints(SceneReader& reader, const SceneNode& group) {
    MotionModelSpec carried;
    reader.read(group, carried, {"waypoints"});
    MotionScript script;
    script.motion_model = carried.motion_model;
    script.speed_m_s = carried.speed_m_s;
    script.height_m = carried.height_m;
    const SceneNode* stops = reader.required(group, "waypoints", SceneNode::Kind::list);
    if (stops == nullptr) return script;
    if (stops->items.empty() || stops->items.size() > kMaxWaypoints) {
        reader.fail(
            *stops,
            fmt::format("has {} entries; 1 to {} are allowed", stops->items.size(), kMaxWaypoints));
    }
    for (const SceneNode& item : stops->items) {
        WaypointSpec stop;
        reader.read(item, stop);
        script.waypoints.push_back({stop.x_m,
                                    stop.y_m,
                                    stop.yaw_deg * kRadPerDeg,
                                    stop.pause_s,
                                    stop.ground_z_m,
                                    stop.move});
    }
    return script;
}

/// Checks that a point is outside all solids; `what` names the point in the message.
void check_free(SceneReader& reader,
                const SceneNode& group,
                const SceneBuilder& builder,
                std::string_view what,
                double time_s,
                const Eigen::Vector3d& p_m) {
    const auto solid = builder.scene().solid_at(p_m);
    if (!solid) return;
    reader.fail(group,
                fmt::format("brings {} into the solid of line {} after {:.2f} s, at ({:.2f}, "
                            "{:.2f}, {:.2f}) m; move the path or the solid",
                            what,
                            builder.line_of(*solid),
                            time_s,
                            p_m.x(),
                            p_m.y(),
                            p_m.z()));
}

}  // namespace

MotionScript read_motion(SceneReader& reader, const SceneNode& node) {
    SceneNode group = node;
    for (SceneNode& value : group.items) {
        // Files of version 0.1 give this key the name `carrier`. Version 0.3 will refuse this name
        // (docs/migration.md).
        if (value.key == "carrier" && group.find("motion_model") == nullptr)
            value.key = "motion_model";
    }
    if (group.find("waypoints") != nullptr) return read_waypoints(reader, group);
    if (group.find("script") != nullptr) return read_script(reader, group);
    reader.fail(group, "needs 'waypoints' or 'script'");
    return {};
}

GroundHeight ground_of(const Scene& scene) {
    // The value lies above the highest riser of the gait, 0.20 m. So a slightly higher block is
    // refused as a step; the machine does not walk through it.
    constexpr double kFootReach_m = 0.25;
    constexpr double kBottomless_m = -1000.0;
    return [&scene, last_m = 0.0](double x_m, double y_m) mutable {
        const auto surfaces = scene.surfaces_at(x_m, y_m);  // highest first
        if (surfaces.empty()) return kBottomless_m;
        for (const SurfaceHeight& surface : surfaces) {
            if (surface.z_m > last_m + kFootReach_m) continue;
            last_m = surface.z_m;
            return last_m;
        }
        return surfaces.back().z_m;  // inside a block: height of a top that is too high for a step
    };
}

void check_way(SceneReader& reader,
               const SceneNode& group,
               const SceneBuilder& builder,
               const ScriptedMotion& motion) {
    constexpr double kStep_s = 0.25;
    const camera::StereoRig rig = *rig_preset(rig_presets().front());
    const Pose T_body_left = rig.body_from_left();
    const std::array<Eigen::Vector3d, 3> carried_m{Eigen::Vector3d::Zero(),
                                                   T_body_left.translation_m,
                                                   (T_body_left * rig.T_left_right).translation_m};
    const double end_s = motion.motion->duration_s() + kStep_s;
    for (double t_s = 0.0; t_s < end_s && !reader.error(); t_s += kStep_s) {
        const Pose T_world_body = motion.motion->at(t_s).T_world_body;
        for (const Eigen::Vector3d& p_body_m : carried_m) {
            check_free(
                reader, group, builder, "the camera or base_link", t_s, T_world_body * p_body_m);
        }
    }
    for (const StepEvent& step : motion.steps) {
        for (const Side side : {Side::left, Side::right}) {
            const Eigen::Vector3d ankle_m(
                0.0, sign_of(side) * rex::kHip_y_m, rex::kAnkleHeight_m - rex::kStand_m);
            check_free(reader, group, builder, "a foot", step.end_s, step.T_world_after * ankle_m);
        }
    }
}

}  // namespace surefoot::sim
