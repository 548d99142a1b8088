// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"

namespace surefoot::sim {

/// Pose of a group of solids in the world.
struct Place {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    double z_m = 0.0;
    double yaw_rad = 0.0;

    [[nodiscard]] Eigen::Vector2d to_world(const Eigen::Vector2d& p_m) const;
    /// Returns the place that is given relative to this place.
    [[nodiscard]] Place then(double x_m, double y_m, double z_m, double heading_deg) const;
};

/// The scene under construction, to which solids are added.
struct Site {
    Scene& scene;
    Place place;
    Rng& rng;
};

/// Material names, for keys that select a material.
using MaterialNames = std::span<const char* const>;
/// Marks a part that has the material of its solid, unless the file names another material.
inline constexpr int kSameMaterial = -2;

// The solids of a scene file. Each struct holds its keys, reports why it is impossible, and adds
// itself to a scene. Lengths in metres; positions are in the frame of the enclosing group;
// heading_deg = 0 points along +x, 90 along +y.

/// A group moves the solids inside it.
struct GroupSpec {
    double x_m = 0.0;
    double y_m = 0.0;
    double z_m = 0.0;
    double heading_deg = 0.0;
    void describe(ConfigVisitor& visitor);
};

struct BoxSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    Label label = Label::object;
    double x_m = kRequired;  ///< x of the middle
    double y_m = kRequired;
    double heading_deg = 0.0;
    double length_m = kRequired;  ///< length along heading_deg
    double width_m = kRequired;
    double bottom_m = 0.0;
    double top_m = kRequired;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// Wedge that climbs along its heading from the middle of its low edge.
struct RampSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    Label label = Label::ramp;
    double x_m = kRequired;
    double y_m = kRequired;
    double heading_deg = 0.0;
    double length_m = kRequired;
    double width_m = kRequired;
    double bottom_m = 0.0;
    double rise_m = kRequired;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const { return std::nullopt; }
    void add(Site& site) const;
};

struct CylinderSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    Label label = Label::object;
    double x_m = kRequired;
    double y_m = kRequired;
    double radius_m = kRequired;
    double bottom_m = 0.0;
    double top_m = kRequired;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// A rectangle along the axes of the world.
struct AreaSpec {
    double min_x_m = kRequired;
    double min_y_m = kRequired;
    double max_x_m = kRequired;
    double max_y_m = kRequired;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
};

struct PitSpec {
    AreaSpec area;
    double depth_m = kRequired;
    void describe(ConfigVisitor& visitor);
};

/// Level sheet, never turned; its pits are labelled as a drop.
struct FloorSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    int pit_material = kSameMaterial;
    Label label = Label::floor;
    AreaSpec area;
    double z_m = 0.0;
    std::vector<PitSpec> pits;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// Four walls around a rectangle, centred on its borders; never turned.
struct WallsSpec {
    MaterialNames materials;
    int material = kRequiredChoice;  ///< walls in front (+x) and on the right (-y)
    int other_material = kSameMaterial;
    AreaSpec area;
    double thickness_m = 0.2;
    double bottom_m = 0.0;
    double top_m = 2.6;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// A board on four legs: a table, or a seat if it is low.
struct TableSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    int leg_material = kSameMaterial;
    Label label = Label::table;
    double x_m = kRequired;  ///< x of the middle
    double y_m = kRequired;
    double heading_deg = 0.0;
    double length_m = kRequired;
    double width_m = kRequired;
    double top_m = 0.72;
    double thickness_m = 0.03;
    double leg_radius_m = 0.025;
    double leg_inset_m = 0.06;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// Wall across the path with an opening: door posts left and right of it, a sill below, and a
/// lintel if `opening_height_m` is not 0. Without a lintel the opening is open to the sky, so that
/// maps of the highest surface show the ground in it.
struct DoorSpec {
    MaterialNames materials;
    int material = kRequiredChoice;  ///< material of the wall
    int post_material = kSameMaterial;
    int sill_material = kSameMaterial;
    double x_m = kRequired;  ///< middle of the opening
    double y_m = kRequired;
    double heading_deg = 0.0;  ///< direction of travel through the door
    double z_m = 0.0;
    double width_m = kRequired;  ///< clear width between the posts
    double thickness_m = 0.12;
    double post_width_m = 0.05;
    double sill_m = 0.0;       ///< height of the sill; 0 = none
    double wall_left_m = 2.0;  ///< length of the wall left of the post, 0 = none
    double wall_right_m = 2.0;
    double wall_height_m = 2.4;
    double opening_height_m = 0.0;
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

enum class StairDirection : std::uint8_t { up, down };
inline constexpr const char* kStairDirectionNames[] = {"up", "down"};

/// Straight flight along its heading. It begins at its first edge: upward, the nose of the first
/// step; downward, the edge of the floor above. `going_m` is the distance from nose to nose. Up: n
/// rises have n treads; the last is the landing if `landing_m` is not 0. Down: n - 1 treads, then a
/// landing if `landing_m` is not 0; the edge of the floor above belongs to that floor.
struct FlightSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    Label label = Label::step;
    double x_m = kRequired;
    double y_m = kRequired;
    double z_m = 0.0;  ///< height of the floor where the flight begins
    double heading_deg = 0.0;
    StairDirection direction = StairDirection::up;
    int steps = 0;  ///< number of rises
    double rise_m = kRequired;
    double going_m = kRequired;
    double width_m = kRequired;
    double landing_m = 0.0;           ///< landing depth; 0 = no landing
    double base_m = 0.0;              ///< depth of the solid below the lower end of the flight
    double nosing_m = 0.0;            ///< overhang of each tread over its riser
    double tread_thickness_m = 0.04;  ///< thickness of a tread with a nosing or without a riser
    bool open = false;                ///< true: the flight has no risers
    double rise_variation_m = 0.0;    ///< largest deviation of a rise; the sum of rises is exact
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

/// Flight around an upright axis; its steps are wedges. Its first edge lies in the direction
/// `start_deg` from the axis.
struct SpiralSpec {
    MaterialNames materials;
    int material = kRequiredChoice;
    int pole_material = kSameMaterial;
    Label label = Label::step;
    double x_m = kRequired;  ///< x of the axis
    double y_m = kRequired;
    double z_m = 0.0;  ///< height of the floor where the stairs begin
    double start_deg = 0.0;
    double turn_deg = kRequired;  ///< turn of one step, positive to the left
    StairDirection direction = StairDirection::up;
    int steps = 0;
    double rise_m = kRequired;
    double inner_radius_m = kRequired;
    double outer_radius_m = kRequired;
    double thickness_m = 0.0;    ///< thickness of a step; 0 = solid to the floor
    double pole_height_m = 0.0;  ///< height above z_m; 0 = no pole
    void describe(ConfigVisitor& visitor);
    [[nodiscard]] std::optional<std::string> problem() const;
    void add(Site& site) const;
};

}  // namespace surefoot::sim
