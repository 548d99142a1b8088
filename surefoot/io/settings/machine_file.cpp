// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/machine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/io/calibration/calibration_kind.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/renamed_keys.hpp"
#include "surefoot/io/settings/yaml_group.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

double radians(double deg) {
    return deg * std::numbers::pi / 180.0;
}

using Group = YamlGroup;

GroundBox read_box(Group& group) {
    GroundBox box;
    box.center_x_tenth_mm = group.length("center_x_m", -2.0, 2.0);
    box.center_y_tenth_mm = group.length("center_y_m", -2.0, 2.0);
    box.length_tenth_mm = group.length("length_m", 0.01, 2.0);
    box.width_tenth_mm = group.length("width_m", 0.01, 2.0);
    return box;
}

/// Reads the mount. The rotation is Rz(yaw) Ry(pitch) Rx(roll), with body axes of REP-103; pitch is
/// positive downward.
void read_mount(Group& mount, MachineFile& out) {
    const Eigen::Vector3d position_m(mount.number("x_m", -2.0, 2.0),
                                     mount.number("y_m", -2.0, 2.0),
                                     mount.number("z_m", -2.0, 2.0));
    const double roll_deg = mount.number("roll_deg", -180.0, 180.0);
    out.mount_pitch_deg = mount.number("pitch_deg", -90.0, 90.0);
    const double yaw_deg = mount.number("yaw_deg", -180.0, 180.0);
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    Pose T_body_mount;
    T_body_mount.rotation = AngleAxisd(radians(yaw_deg), Vector3d::UnitZ()) *
                            AngleAxisd(radians(out.mount_pitch_deg), Vector3d::UnitY()) *
                            AngleAxisd(radians(roll_deg), Vector3d::UnitX());
    T_body_mount.translation_m = position_m;
    out.T_body_left = T_body_mount * T_body_optical();
}

void read_body(Group& group, Body& body) {
    body.sway_tenth_mm = group.length("sway_m", 0.0, 0.5);
    group.list("parts", Body::kMaxParts, [&](Group& item) {
        BodyPart part;
        std::ignore = item.text("name", 40);  // for human readers only
        part.box = read_box(item);
        part.low_tenth_mm = item.length("low_m", 0.0001, 2.0);
        part.high_tenth_mm = item.length("high_m", 0.0001, 3.0);
        body.parts[static_cast<std::size_t>(body.count++)] = part;
    });
}

void read_joint(Group& group, std::vector<JointRange>& joints) {
    JointRange joint;
    joint.name = group.text("name", 40);
    joint.min_deg = group.number("min_deg", -180.0, 180.0);
    joint.max_deg = group.number("max_deg", -180.0, 180.0);
    if (joint.min_deg > joint.max_deg)
        group.fail("max_deg",
                   fmt::format("{} is below min_deg {}; max_deg must be the larger angle",
                               joint.max_deg,
                               joint.min_deg));
    joints.push_back(std::move(joint));
}

void read_movement(Group& group, Machine& machine) {
    const int code = group.integer("code", 1, Machine::kMovementCodes - 1);
    Movement movement;
    const std::string name = group.text("name", movement.name.size() - 1);
    std::copy_n(
        name.begin(), std::min(name.size(), movement.name.size() - 1), movement.name.begin());
    movement.configured = true;
    movement.forward_tenth_mm = group.length("forward_m", -2.0, 2.0);
    movement.left_tenth_mm = group.length("left_m", -2.0, 2.0);
    const double turn_rad = radians(group.number("turn_deg", -30.0, 30.0));
    movement.cos_turn = std::cos(turn_rad);
    movement.sin_turn = std::sin(turn_rad);
    const std::string name_of_class = group.text("class", 16);
    if (name_of_class == "stair")
        movement.movement_class = MovementClass::stair;
    else if (name_of_class != "walk")
        group.fail("class", quoted(name_of_class) + " is neither walk nor stair");
    if (code == 0) return;  // the code is missing or refused; finish() or another check reports it
    Movement& slot = machine.movements[static_cast<std::size_t>(code)];
    if (slot.configured)
        group.fail("code", fmt::format("{} appears twice; give each movement its own code", code));
    slot = movement;
}

StepLimits read_step(Group& group) {
    StepLimits limits;
    limits.enabled = group.boolean("enabled");
    limits.up_tenth_mm = group.length("up_m", 0.0, 0.3);
    limits.down_tenth_mm = group.length("down_m", 0.0, 0.3);
    return limits;
}

/// The ranges are those of Machine::problem(), in the units of the file.
void read_limits(Group& group, GateLimits& limits) {
    group.group("walk", [&](Group& step) { limits.step[0] = read_step(step); });
    group.group("stair", [&](Group& step) { limits.step[1] = read_step(step); });
    limits.min_normal_z = std::cos(radians(group.number("tilt_deg", 0.0, 11.0)));
    limits.patch_side_tenth_mm = group.length("patch_side_m", 0.02, 0.1);
    limits.patch_residual_tenth_mm = group.length("patch_residual_m", 0.0001, 0.05);
    limits.patch_sigma_tenth_mm = group.length("patch_sigma_m", 0.0001, 0.01);
    limits.sigma_factor = group.number("sigma_factor", 3.0, 10.0);
    limits.patch_independent_cells = group.integer("patch_independent_cells", 1, 16);
    limits.cell_sigma_tenth_mm = group.length("cell_sigma_m", 0.0001, 0.03);
    limits.swing_clearance_tenth_mm = group.length("swing_clearance_m", 0.0001, 0.2);
    limits.foot_margin_tenth_mm = group.length("foot_margin_m", 0.0, 0.2);
    limits.drop_tenth_mm = group.length("drop_m", 0.0001, 0.1);
    limits.drop_band_tenth_mm = group.length("drop_band_m", 0.05, 0.5);
    // in range: number() gives at most 1.0
    limits.drop_evidence = static_cast<std::uint8_t>(
        // in range: number() gives 0.004 to 1.0
        std::max(1L, std::lround(255.0 * group.number("drop_evidence", 0.004, 1.0))));
    limits.drift_tenth_mm = group.length("drift_m", 0.0001, 0.1);
    limits.tread_share_permille =
        // in range: number() gives 0.5 to 1.0
        static_cast<std::int32_t>(std::lround(1e3 * group.number("tread_share", 0.5, 1.0)));
    limits.tread_overhang_tenth_mm = group.length("tread_overhang_m", 0.0, 0.1);
    limits.frame_age_ns = group.duration_ns("frame_age_ms", 1, 1000);
    limits.pose_age_ns = group.duration_ns("pose_age_ms", 1, 1000);
    limits.future_tolerance_ns = group.duration_ns("future_tolerance_ms", 0, 100);
    limits.verdict_ttl_ns = group.duration_ns("verdict_ttl_ms", 1, 1000);
    limits.attestation_radius_tenth_mm = group.length("attestation_radius_m", 0.0, 2.0);
}

/// Refuses a limit of class walk that its gait cannot reach. A foot cannot land higher than
/// `swing_clearance`, the height to which the gait lifts the foot.
void check_gait(Group& root, const GateLimits& limits) {
    constexpr double kTenthMmPerMetre = 1e4;
    const StepLimits& walk = limits.step[static_cast<std::size_t>(MovementClass::walk)];
    if (!walk.enabled || walk.up_tenth_mm <= limits.swing_clearance_tenth_mm) return;
    root.fail("limits",
              fmt::format("walk.up_m {} is above swing_clearance_m {}: movements of class walk do "
                          "not lift a foot that high; give such movements the class stair",
                          walk.up_tenth_mm / kTenthMmPerMetre,
                          limits.swing_clearance_tenth_mm / kTenthMmPerMetre));
}

void read_document(YamlReader& reader, Group& root, MachineFile& out) {
    Machine& machine = out.machine;
    out.name = root.text("name", 60);
    machine.sole_depth_tenth_mm = root.length("sole_depth_m", 0.0001, 3.0);
    root.group("mount", [&](Group& mount) { read_mount(mount, out); });
    root.group("feet", [&](Group& feet) {
        machine.ankle_from_heel_tenth_mm = feet.length("ankle_from_heel_m", 0.0, 2.0);
        feet.group("left", [&](Group& box) { machine.left_foot = read_box(box); });
        feet.group("right", [&](Group& box) { machine.right_foot = read_box(box); });
    });
    root.group("body", [&](Group& body) { read_body(body, machine.body); });
    root.group("fastest", [&](Group& fastest) {
        out.speed_m_s = fastest.number("speed_m_s", 0.0, 100.0);
        out.turn_deg_s = fastest.number("turn_deg_s", 0.0, 3600.0);
    });
    root.list("joints", 64, [&](Group& joint) { read_joint(joint, out.joints); });
    root.list("movements", Machine::kMovementCodes - 1, [&](Group& movement) {
        read_movement(movement, machine);
    });
    root.group("limits", [&](Group& limits) { read_limits(limits, machine.limits); });
    check_gait(root, machine.limits);
    out.deviations = read_deviations(reader, root);
    root.finish();
}

/// Gives keys with the names of version 0.1 the names of today (docs/migration.md). Returns a
/// sentence for each renamed key.
std::vector<std::string> use_current_names(YamlNode& document, const std::string& file) {
    constexpr std::string_view kFormer = "vouch_radius_m";
    constexpr std::string_view kCurrent = "attestation_radius_m";
    std::vector<std::string> notes;
    const auto rename = [&](std::string& name, int line, std::string_view prefix) {
        if (name != fmt::format("{}{}", prefix, kFormer)) return;
        name = fmt::format("{}{}", prefix, kCurrent);
        notes.push_back(
            fmt::format("{}:{}: {}", file, line, renamed_note(quoted(kFormer), quoted(kCurrent))));
    };
    for (YamlNode& group : document.items) {
        if (group.key == "limits" && group.find(kCurrent) == nullptr) {
            for (YamlNode& limit : group.items) rename(limit.key, limit.line, "");
        }
        if (group.key != "deviations") continue;
        for (YamlNode& deviation : group.items) {
            for (YamlNode& field : deviation.items) {
                if (field.key == "key") rename(field.scalar, field.line, "limits.");
            }
        }
    }
    return notes;
}

}  // namespace

Result<MachineFile> parse_machine(std::string_view yaml, const std::string& file) {
    Result<YamlNode> document = parse_yaml(yaml, file);
    if (!document) return usage_error(document.error().message);
    MachineFile out;
    out.notes = use_current_names(*document, file);
    YamlReader reader(file, *document);
    const CalibrationKind kind = kind_of_document(*document);
    if (kind != CalibrationKind::machine && kind != CalibrationKind::unknown)
        return usage_error(
            fmt::format("{}: this looks like {}, not like a machine file", file, title_of(kind)));
    Group root(reader, *document, "", "machine file");
    read_document(reader, root, out);
    if (reader.error()) return usage_error(reader.error()->message);
    if (const char* why = out.machine.problem()) return usage_error(file + ": " + why);
    out.hash = fnv1a(yaml);
    return out;
}

Result<MachineFile> read_machine(const std::string& path) {
    const Result<std::string> text = read_file(path, kMaxBytes);
    if (!text) return text.error();
    return parse_machine(*text, path);
}

}  // namespace surefoot::io
