// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/solids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

/// Limit of coordinates. A scene is a room or a path, not a landscape.
constexpr double kReach_m = 100.0;
constexpr double kMinSize_m = 1e-3;

void describe_position(ConfigVisitor& visitor, double& x_m, double& y_m) {
    visitor.number(
        "x_m", x_m, -kReach_m, kReach_m, "position along x (ahead) in the group or scene");
    visitor.number(
        "y_m", y_m, -kReach_m, kReach_m, "position along y (left) in the group or scene");
}

void describe_heading(ConfigVisitor& visitor, double& heading_deg) {
    visitor.number("heading_deg",
                   heading_deg,
                   -360.0,
                   360.0,
                   "angle of the object in the group or scene: 0 = along +x, 90 = along +y");
}

void describe_size(ConfigVisitor& visitor, const char* key, double& size_m) {
    visitor.number(key,
                   size_m,
                   kMinSize_m,
                   kReach_m,
                   "dimension that the key names, for example the length of the object");
}

void describe_height(ConfigVisitor& visitor, const char* key, double& z_m) {
    visitor.number(
        key,
        z_m,
        -kReach_m,
        kReach_m,
        "height, above the origin of the group or scene, of the part that the key names");
}

std::optional<std::string> not_above(double bottom_m, double top_m) {
    if (top_m - bottom_m >= kMinSize_m) return std::nullopt;
    return fmt::format(
        "top_m {} must be above bottom_m {} by at least {} m", top_m, bottom_m, kMinSize_m);
}

int or_same(int material, int own) {
    return material == kSameMaterial ? own : material;
}

/// Makes a box in the frame of a place.
Prism placed_box(const Place& place,
                 const Vector2d& center_m,
                 const Vector2d& size_m,
                 double bottom_m,
                 double top_m) {
    return make_box(
        place.to_world(center_m), size_m, place.z_m + bottom_m, place.z_m + top_m, place.yaw_rad);
}

Rect shifted(const AreaSpec& area, const Place& place) {
    return {Vector2d(area.min_x_m, area.min_y_m) + place.at_m,
            Vector2d(area.max_x_m, area.max_y_m) + place.at_m};
}

}  // namespace

Vector2d Place::to_world(const Vector2d& p_m) const {
    if (yaw_rad == 0.0) return at_m + p_m;
    const double c = std::cos(yaw_rad);
    const double s = std::sin(yaw_rad);
    return at_m + Vector2d(c * p_m.x() - s * p_m.y(), s * p_m.x() + c * p_m.y());
}

Place Place::then(double x_m, double y_m, double z_above_m, double heading_deg) const {
    return {
        to_world({x_m, y_m}), z_m + z_above_m, yaw_rad + heading_deg * std::numbers::pi / 180.0};
}

void GroupSpec::describe(ConfigVisitor& visitor) {
    describe_position(visitor, x_m, y_m);
    describe_height(visitor, "z_m", z_m);
    describe_heading(visitor, heading_deg);
}

void BoxSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the box");
    visitor.enumeration("label", label, kLabelNames, "class of the box in the ground truth");
    describe_position(visitor, x_m, y_m);
    describe_heading(visitor, heading_deg);
    describe_size(visitor, "length_m", length_m);
    describe_size(visitor, "width_m", width_m);
    describe_height(visitor, "bottom_m", bottom_m);
    describe_height(visitor, "top_m", top_m);
}

std::optional<std::string> BoxSpec::problem() const {
    return not_above(bottom_m, top_m);
}

void BoxSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, 0.0, heading_deg);
    site.scene.add(
        placed_box(place, Vector2d::Zero(), {length_m, width_m}, bottom_m, top_m), material, label);
}

void RampSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the ramp");
    visitor.enumeration("label", label, kLabelNames, "class of the ramp in the ground truth");
    describe_position(visitor, x_m, y_m);
    describe_heading(visitor, heading_deg);
    describe_size(visitor, "length_m", length_m);
    describe_size(visitor, "width_m", width_m);
    describe_height(visitor, "bottom_m", bottom_m);
    describe_size(visitor, "rise_m", rise_m);
}

void RampSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, bottom_m, heading_deg);
    site.scene.add(make_ramp(place.at_m, length_m, width_m, place.z_m, rise_m, place.yaw_rad),
                   material,
                   label);
}

void CylinderSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the cylinder");
    visitor.enumeration("label", label, kLabelNames, "class of the cylinder in the ground truth");
    describe_position(visitor, x_m, y_m);
    describe_size(visitor, "radius_m", radius_m);
    describe_height(visitor, "bottom_m", bottom_m);
    describe_height(visitor, "top_m", top_m);
}

std::optional<std::string> CylinderSpec::problem() const {
    return not_above(bottom_m, top_m);
}

void CylinderSpec::add(Site& site) const {
    const Place& place = site.place;
    site.scene.add(
        Cylinder(place.to_world({x_m, y_m}), radius_m, place.z_m + bottom_m, place.z_m + top_m),
        material,
        label);
}

void AreaSpec::describe(ConfigVisitor& visitor) {
    visitor.number("min_x_m", min_x_m, -kReach_m, kReach_m, "x of the rear border of the area");
    visitor.number("min_y_m", min_y_m, -kReach_m, kReach_m, "y of the right border of the area");
    visitor.number("max_x_m", max_x_m, -kReach_m, kReach_m, "x of the front border of the area");
    visitor.number("max_y_m", max_y_m, -kReach_m, kReach_m, "y of the left border of the area");
}

std::optional<std::string> AreaSpec::problem() const {
    if (max_x_m - min_x_m < kMinSize_m) {
        return fmt::format("max_x_m {} must be at least 1 mm above min_x_m {}", max_x_m, min_x_m);
    }
    if (max_y_m - min_y_m < kMinSize_m) {
        return fmt::format("max_y_m {} must be at least 1 mm above min_y_m {}", max_y_m, min_y_m);
    }
    return std::nullopt;
}

void PitSpec::describe(ConfigVisitor& visitor) {
    area.describe(visitor);
    describe_size(visitor, "depth_m", depth_m);
}

void FloorSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the floor");
    visitor.choice("pit_material", pit_material, materials, "material of the pits in the floor");
    visitor.enumeration("label", label, kLabelNames, "class of the floor in the ground truth");
    area.describe(visitor);
    describe_height(visitor, "z_m", z_m);
}

std::optional<std::string> FloorSpec::problem() const {
    if (auto wrong = area.problem()) return wrong;
    for (const PitSpec& pit : pits) {
        if (auto wrong = pit.area.problem()) return "a pit: " + *wrong;
    }
    return std::nullopt;
}

void FloorSpec::add(Site& site) const {
    std::vector<Pit> holes;
    holes.reserve(pits.size());
    for (const PitSpec& pit : pits) holes.push_back({shifted(pit.area, site.place), pit.depth_m});
    site.scene.add_floor(Floor(shifted(area, site.place), site.place.z_m + z_m, std::move(holes)),
                         material,
                         or_same(pit_material, material),
                         label);
}

void WallsSpec::describe(ConfigVisitor& visitor) {
    visitor.choice(
        "material", material, materials, "material of the walls in front and on the right");
    visitor.choice("other_material",
                   other_material,
                   materials,
                   "material of the walls behind and on the left");
    area.describe(visitor);
    describe_size(visitor, "thickness_m", thickness_m);
    describe_height(visitor, "bottom_m", bottom_m);
    describe_height(visitor, "top_m", top_m);
}

std::optional<std::string> WallsSpec::problem() const {
    if (auto wrong = area.problem()) return wrong;
    return not_above(bottom_m, top_m);
}

void WallsSpec::add(Site& site) const {
    const Rect around = shifted(area, site.place);
    const Vector2d center = 0.5 * (around.min_m + around.max_m);
    const Vector2d size = around.max_m - around.min_m;
    const int other = or_same(other_material, material);
    const auto wall = [&](double x, double y, const Vector2d& extent, int look) {
        site.scene.add(make_box({x, y}, extent, site.place.z_m + bottom_m, site.place.z_m + top_m),
                       look,
                       Label::wall);
    };
    wall(around.max_m.x(), center.y(), {thickness_m, size.y()}, material);
    wall(around.min_m.x(), center.y(), {thickness_m, size.y()}, other);
    wall(center.x(), around.max_m.y(), {size.x(), thickness_m}, other);
    wall(center.x(), around.min_m.y(), {size.x(), thickness_m}, material);
}

void TableSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the table");
    visitor.choice("leg_material", leg_material, materials, "material of the legs of the table");
    visitor.enumeration("label", label, kLabelNames, "class of the table in the ground truth");
    describe_position(visitor, x_m, y_m);
    describe_heading(visitor, heading_deg);
    describe_size(visitor, "length_m", length_m);
    describe_size(visitor, "width_m", width_m);
    describe_height(visitor, "top_m", top_m);
    describe_size(visitor, "thickness_m", thickness_m);
    describe_size(visitor, "leg_radius_m", leg_radius_m);
    visitor.number("leg_inset_m",
                   leg_inset_m,
                   0.0,
                   1.0,
                   "distance from the borders of the table to the middle of a leg");
}

std::optional<std::string> TableSpec::problem() const {
    if (auto wrong = not_above(0.0, top_m - thickness_m)) {
        return fmt::format(
            "thickness_m {} leaves no room for legs below top_m {}; make the board thinner or the "
            "table higher",
            thickness_m,
            top_m);
    }
    if (2.0 * leg_inset_m >= std::min(length_m, width_m)) {
        return fmt::format(
            "leg_inset_m {} must be below half of the shorter side of the table, which is {} x {} "
            "m",
            leg_inset_m,
            length_m,
            width_m);
    }
    return std::nullopt;
}

void TableSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, 0.0, heading_deg);
    const double under_m = top_m - thickness_m;
    site.scene.add(
        placed_box(place, Vector2d::Zero(), {length_m, width_m}, under_m, top_m), material, label);
    const double along_m = 0.5 * length_m - leg_inset_m;
    const double across_m = 0.5 * width_m - leg_inset_m;
    for (const double dx_m : {-along_m, along_m}) {
        for (const double dy_m : {-across_m, across_m}) {
            const Vector2d foot_m = place.to_world({dx_m, dy_m});
            site.scene.add(Cylinder(foot_m, leg_radius_m, place.z_m, place.z_m + under_m),
                           or_same(leg_material, material),
                           label);
        }
    }
}

void DoorSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the wall");
    visitor.choice(
        "post_material", post_material, materials, "material of the posts and the lintel");
    visitor.choice("sill_material", sill_material, materials, "material of the sill");
    describe_position(visitor, x_m, y_m);
    describe_heading(visitor, heading_deg);
    describe_height(visitor, "z_m", z_m);
    visitor.number("width_m", width_m, 0.1, 10.0, "clear width between the posts of the door");
    visitor.number("thickness_m", thickness_m, 0.01, 2.0, "thickness of the wall");
    visitor.number("post_width_m",
                   post_width_m,
                   0.005,
                   1.0,
                   "width of each post, across the direction of travel");
    visitor.number("sill_m", sill_m, 0.0, 0.5, "height of the sill; 0 = no sill");
    visitor.number(
        "wall_left_m", wall_left_m, 0.0, kReach_m, "length of the wall beside the left post");
    visitor.number(
        "wall_right_m", wall_right_m, 0.0, kReach_m, "length of the wall beside the right post");
    visitor.number("wall_height_m", wall_height_m, 0.1, 10.0, "height of the whole wall");
    visitor.number("opening_height_m",
                   opening_height_m,
                   0.0,
                   10.0,
                   "height of the opening below the lintel; 0 = no lintel");
}

std::optional<std::string> DoorSpec::problem() const {
    if (opening_height_m > 0.0 && opening_height_m <= sill_m) {
        return fmt::format("opening_height_m {} must be above sill_m {}", opening_height_m, sill_m);
    }
    if (opening_height_m > 0.0 && wall_height_m - opening_height_m < kMinSize_m) {
        return fmt::format(
            "wall_height_m {} leaves no lintel above opening_height_m {}; make the wall higher or "
            "the opening lower",
            wall_height_m,
            opening_height_m);
    }
    return std::nullopt;
}

void DoorSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, z_m, heading_deg);
    // Adds a part of the wall from y = `right_m` to y = `left_m` in the frame of the door.
    const auto part =
        [&](double right_m, double left_m, double bottom_m, double top_m, int look, Label label) {
            if (left_m - right_m < kMinSize_m || top_m - bottom_m < kMinSize_m) return;
            site.scene.add(placed_box(place,
                                      {0.0, 0.5 * (right_m + left_m)},
                                      {thickness_m, left_m - right_m},
                                      bottom_m,
                                      top_m),
                           look,
                           label);
        };
    const double half_m = 0.5 * width_m;
    const double outer_m = half_m + post_width_m;
    const int posts = or_same(post_material, material);
    part(half_m, outer_m, 0.0, wall_height_m, posts, Label::door);
    part(-outer_m, -half_m, 0.0, wall_height_m, posts, Label::door);
    part(outer_m, outer_m + wall_left_m, 0.0, wall_height_m, material, Label::wall);
    part(-outer_m - wall_right_m, -outer_m, 0.0, wall_height_m, material, Label::wall);
    part(-half_m, half_m, 0.0, sill_m, or_same(sill_material, material), Label::sill);
    if (opening_height_m > 0.0) {
        part(-half_m, half_m, opening_height_m, wall_height_m, posts, Label::door);
    }
}

}  // namespace surefoot::sim
