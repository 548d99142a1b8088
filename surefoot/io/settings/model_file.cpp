// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/model_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <numbers>
#include <optional>
#include <utility>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/yaml_group.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxParts = 200;
constexpr std::size_t kMaxName = 60;
constexpr double kReach_m = 5.0;
constexpr double kSmallest_m = 0.001;
constexpr const char* kRoot = "base_link";

double radians(double deg) {
    return deg * std::numbers::pi / 180.0;
}

template <typename Part>
const Part* find(const std::vector<Part>& parts, std::string_view name) {
    const auto found =
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == name; });
    return found == parts.end() ? nullptr : &*found;
}

template <typename Part>
std::string likely(const std::vector<Part>& parts, const std::string& name) {
    std::vector<std::string> names;
    names.reserve(parts.size());
    for (const Part& part : parts) names.push_back(part.name);
    return did_you_mean(name, names);
}

const ModelJoint* joint_above(const std::vector<ModelJoint>& joints, std::string_view link) {
    const auto found = std::find_if(
        joints.begin(), joints.end(), [&](const ModelJoint& j) { return j.child == link; });
    return found == joints.end() ? nullptr : &*found;
}

/// Reads a name. Names are written to a URDF, and other programs use them as identifiers.
std::string read_name(YamlGroup& group, const char* key) {
    std::string name = group.text(key, kMaxName);
    const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_';
    });
    if (!plain)
        group.fail(key,
                   fmt::format("{}: a name may have only letters, digits and _", quoted(name)));
    return name;
}

template <typename Part>
std::string read_new_name(YamlGroup& group, const std::vector<Part>& parts) {
    std::string name = read_name(group, "name");
    if (find(parts, name) != nullptr)
        group.fail("name", quoted(name) + " is used twice: give each its own name");
    return name;
}

double number_or_zero(YamlGroup& group, const char* key, double limit) {
    return group.has(key) ? group.number(key, -limit, limit) : 0.0;
}

ModelPlace read_place(YamlGroup& group) {
    ModelPlace place;
    place.position_m = {number_or_zero(group, "x_m", kReach_m),
                        number_or_zero(group, "y_m", kReach_m),
                        number_or_zero(group, "z_m", kReach_m)};
    place.roll_pitch_yaw_rad = {radians(number_or_zero(group, "roll_deg", 180.0)),
                                radians(number_or_zero(group, "pitch_deg", 180.0)),
                                radians(number_or_zero(group, "yaw_deg", 180.0))};
    return place;
}

/// Parses a colour "#rrggbb"; no value for other text.
std::optional<std::array<std::uint8_t, 3>> parse_color(std::string_view text) {
    constexpr std::size_t kLength = 7;
    if (text.size() != kLength || text.front() != '#') return std::nullopt;
    std::array<std::uint8_t, 3> rgb{};
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const char* const begin = text.data() + 1 + 2 * i;
        constexpr int kHex = 16;
        const auto [end, error] = std::from_chars(begin, begin + 2, rgb[i], kHex);
        if (error != std::errc{} || end != begin + 2) return std::nullopt;
    }
    return rgb;
}

void read_material(YamlGroup& group, MachineModel& model) {
    ModelMaterial material;
    material.name = read_new_name(group, model.materials);
    const std::string color = group.text("color", kMaxName);
    if (const auto rgb = parse_color(color))
        material.rgb = *rgb;
    else
        group.fail("color", quoted(color) + " is not a color: write it as \"#0072b2\"");
    model.materials.push_back(std::move(material));
}

ModelBox read_box(YamlGroup& group, const MachineModel& model) {
    ModelBox box;
    box.size_m = {group.number("size_x_m", kSmallest_m, kReach_m),
                  group.number("size_y_m", kSmallest_m, kReach_m),
                  group.number("size_z_m", kSmallest_m, kReach_m)};
    box.in_link = read_place(group);
    box.material = group.text("material", kMaxName);
    if (find(model.materials, box.material) == nullptr)
        group.fail("material",
                   fmt::format("there is no material {} in `materials`{}",
                               quoted(box.material),
                               likely(model.materials, box.material)));
    return box;
}

void read_link(YamlGroup& group, MachineModel& model) {
    ModelLink link;
    link.name = read_new_name(group, model.links);
    if (group.has("boxes"))
        group.list("boxes", kMaxParts, [&](YamlGroup& box) {
            link.boxes.push_back(read_box(box, model));
        });
    model.links.push_back(std::move(link));
}

void read_motion(YamlGroup& group, ModelJoint& joint) {
    const std::string axis = group.text("axis", kMaxName);
    if (axis == "x" || axis == "y" || axis == "z")
        joint.axis = Vector3d::Unit(axis.front() - 'x');
    else
        group.fail("axis",
                   quoted(axis) +
                       " is not x, y or z: turn the joint (roll_deg, pitch_deg, "
                       "yaw_deg) until its axis is one of them");
    const double min_deg = group.number("min_deg", -360.0, 360.0);
    const double max_deg = group.number("max_deg", -360.0, 360.0);
    if (!(min_deg < max_deg))
        group.fail("max_deg",
                   fmt::format("the range from min_deg {} to {} is empty: give the larger angle "
                               "here, or make the joint fixed",
                               min_deg,
                               max_deg));
    const double stand_deg = group.number("stand_deg", -360.0, 360.0);
    if (stand_deg < min_deg || stand_deg > max_deg)
        group.fail("stand_deg",
                   fmt::format("{} is outside {} .. {}, the range from min_deg to max_deg",
                               stand_deg,
                               min_deg,
                               max_deg));
    joint.moves = true;
    joint.min_rad = radians(min_deg);
    joint.max_rad = radians(max_deg);
    joint.stand_rad = radians(stand_deg);
}

std::string read_end(YamlGroup& group, const char* key, const MachineModel& model) {
    std::string name = group.text(key, kMaxName);
    if (find(model.links, name) == nullptr)
        group.fail(
            key,
            fmt::format(
                "there is no link {} in `links`{}", quoted(name), likely(model.links, name)));
    return name;
}

/// Checks that the links still form a tree after this joint is added; reports the reason if not.
bool fits_into_tree(YamlGroup& group, const MachineModel& model, const ModelJoint& joint) {
    if (const ModelJoint* other = joint_above(model.joints, joint.child)) {
        group.fail("child",
                   fmt::format("{} is already the child of joint {}: remove one of the two joints",
                               quoted(joint.child),
                               quoted(other->name)));
        return false;
    }
    std::string_view link = joint.parent;
    while (const ModelJoint* above = joint_above(model.joints, link)) link = above->parent;
    if (link != joint.child) return true;
    group.fail("child",
               fmt::format("{} would be its own ancestor: give the joint another parent",
                           quoted(joint.child)));
    return false;
}

void read_joint(YamlGroup& group, MachineModel& model) {
    ModelJoint joint;
    joint.name = read_new_name(group, model.joints);
    const std::string kind = group.text("kind", kMaxName);
    joint.parent = read_end(group, "parent", model);
    joint.child = read_end(group, "child", model);
    joint.in_parent = read_place(group);
    if (kind == "revolute")
        read_motion(group, joint);
    else if (kind != "fixed")
        group.fail("kind", quoted(kind) + " is neither fixed nor revolute");
    if (fits_into_tree(group, model, joint)) model.joints.push_back(std::move(joint));
}

/// Checks that base_link is the only root. There is no loop, so every link has an ancestor that is
/// a root.
void check_root(YamlGroup& root, const MachineModel& model) {
    if (find(model.links, kRoot) == nullptr)
        root.fail("links", fmt::format("there is no link {}: give the root link this name", kRoot));
    if (const ModelJoint* above = joint_above(model.joints, kRoot))
        root.fail(
            "joints",
            fmt::format("{} is the root and cannot be a child: swap parent and child of joint {}",
                        kRoot,
                        quoted(above->name)));
    for (std::size_t i = 0; i < model.links.size(); ++i) {
        const std::string& name = model.links[i].name;
        if (name == kRoot || joint_above(model.joints, name) != nullptr) continue;
        root.fail_item("links",
                       i,
                       "name",
                       fmt::format("{} is not the child of a joint, but only {} can be the root: "
                                   "add a joint that has this link as its child",
                                   quoted(name),
                                   kRoot));
    }
}

}  // namespace

Pose ModelPlace::pose() const {
    Pose T;
    T.rotation = AngleAxisd(roll_pitch_yaw_rad.z(), Vector3d::UnitZ()) *
                 AngleAxisd(roll_pitch_yaw_rad.y(), Vector3d::UnitY()) *
                 AngleAxisd(roll_pitch_yaw_rad.x(), Vector3d::UnitX());
    T.translation_m = position_m;
    return T;
}

std::vector<const ModelJoint*> MachineModel::moving_joints() const {
    std::vector<const ModelJoint*> moving;
    for (const ModelJoint& joint : joints) {
        if (joint.moves) moving.push_back(&joint);
    }
    return moving;
}

Pose MachineModel::T_base_link(std::string_view link, const std::vector<double>& angles_rad) const {
    SUREFOOT_ASSERT(find(links, link) != nullptr);
    const std::vector<const ModelJoint*> moving = moving_joints();
    SUREFOOT_ASSERT(angles_rad.size() == moving.size());
    Pose T;
    for (const ModelJoint* joint = joint_above(joints, link); joint != nullptr;
         joint = joint_above(joints, joint->parent)) {
        Pose T_parent_child = joint->in_parent.pose();
        const auto found = std::find(moving.begin(), moving.end(), joint);
        if (found != moving.end()) {
            const auto which = static_cast<std::size_t>(found - moving.begin());
            T_parent_child.rotation =
                T_parent_child.rotation * AngleAxisd(angles_rad[which], joint->axis);
        }
        T = T_parent_child * T;
    }
    return T;
}

Result<MachineModel> parse_model(std::string_view yaml, const std::string& file) {
    Result<YamlNode> document = parse_yaml(yaml, file);
    if (!document) return usage_error(document.error().message);
    YamlReader reader(file, *document);
    YamlGroup root(reader, *document, "", "model file");
    MachineModel model;
    model.name = read_name(root, "name");
    root.list("materials", kMaxParts, [&](YamlGroup& group) { read_material(group, model); });
    root.list("links", kMaxParts, [&](YamlGroup& group) { read_link(group, model); });
    root.list("joints", kMaxParts, [&](YamlGroup& group) { read_joint(group, model); });
    root.finish();
    check_root(root, model);
    if (reader.error()) return usage_error(reader.error()->message);
    return model;
}

Result<MachineModel> read_model(const std::string& path) {
    const Result<std::string> text = read_file(path, kMaxBytes);
    if (!text) return usage_error(text.error().message);
    return parse_model(*text, path);
}

}  // namespace surefoot::io
