// SPDX-License-Identifier: Apache-2.0
#include "sim/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "sim/motion_script.hpp"
#include "sim/rigs.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

constexpr double deg(double angle_deg) {
    return angle_deg * std::numbers::pi / 180.0;
}

int material(Scene& scene, Pattern pattern, double albedo, double contrast, double texel_m) {
    Material m;
    m.pattern = pattern;
    m.albedo = albedo;
    m.contrast = contrast;
    m.texel_m = texel_m;
    m.seed = scene.materials().size();
    return scene.add_material(m);
}

/// Floor of the room; its walls, far outside the map, close the view.
Rect room_area() {
    return {{-3.0, -5.0}, {9.0, 5.0}};
}

void add_walls(Scene& scene, double bottom_m) {
    constexpr double kThickness_m = 0.2;
    constexpr double kTop_m = 2.6;
    const Rect area = room_area();
    const Vector2d center = 0.5 * (area.min_m + area.max_m);
    const Vector2d size = area.max_m - area.min_m;
    const int plaster = material(scene, Pattern::plaster, 0.6, 0.45, 0.005);
    const int patches = material(scene, Pattern::patches, 0.5, 0.6, 0.006);
    const Vector2d across(kThickness_m, size.y());
    const Vector2d along(size.x(), kThickness_m);
    const auto wall = [&](double x_m, double y_m, const Vector2d& extent, int look) {
        scene.add(make_box({x_m, y_m}, extent, bottom_m, kTop_m), look, Label::wall);
    };
    wall(area.max_m.x(), center.y(), across, patches);
    wall(area.min_m.x(), center.y(), across, plaster);
    wall(center.x(), area.max_m.y(), along, plaster);
    wall(center.x(), area.min_m.y(), along, patches);
}

void add_table(Scene& scene, const Rect& area, double top_m) {
    constexpr double kThickness_m = 0.03;
    constexpr double kLegRadius_m = 0.025;
    constexpr double kLegInset_m = 0.06;
    const int board = material(scene, Pattern::wood, 0.55, 0.6, 0.0015);
    const int legs = material(scene, Pattern::concrete, 0.25, 0.5, 0.002);
    const Vector2d center = 0.5 * (area.min_m + area.max_m);
    scene.add(make_box(center, area.max_m - area.min_m, top_m - kThickness_m, top_m),
              board,
              Label::table);
    for (const double x_m : {area.min_m.x() + kLegInset_m, area.max_m.x() - kLegInset_m}) {
        for (const double y_m : {area.min_m.y() + kLegInset_m, area.max_m.y() - kLegInset_m}) {
            scene.add(
                Cylinder({x_m, y_m}, kLegRadius_m, 0.0, top_m - kThickness_m), legs, Label::table);
        }
    }
}

/// Three steps, the last one as deep as a platform.
void add_demo_stairs(Scene& scene) {
    using namespace demo_stairs;
    constexpr double kPlatform_m = 0.8;
    const int wood = material(scene, Pattern::wood, 0.5, 0.7, 0.0015);
    for (int step = 0; step < 3; ++step) {
        const double depth_m = step < 2 ? kGoing_m : kGoing_m + kPlatform_m;
        const double front_m = kFirstRiser_x_m + step * kGoing_m;
        scene.add(make_box({front_m + 0.5 * depth_m, 0.0},
                           {depth_m, 2.0 * kStairHalfWidth_m},
                           0.0,
                           (step + 1) * kRise_m),
                  wood,
                  Label::step);
    }
}

/// 1:8, up to the height of the first step, with a landing behind.
void add_demo_ramp(Scene& scene) {
    using namespace demo_stairs;
    constexpr double kLanding_m = 1.2;
    const int concrete = material(scene, Pattern::concrete, 0.42, 0.7, 0.002);
    scene.add(
        make_ramp({kRampFoot_x_m, kRampCenter_y_m}, kRampLength_m, kRampWidth_m, 0.0, kRise_m),
        concrete,
        Label::ramp);
    scene.add(make_box({kRampFoot_x_m + kRampLength_m + 0.5 * kLanding_m, kRampCenter_y_m},
                       {kLanding_m, kRampWidth_m},
                       0.0,
                       kRise_m),
              concrete,
              Label::step);
}

std::shared_ptr<const Motion> trolley(std::vector<Waypoint> stops, std::uint64_t seed) {
    MotionScript script;
    script.waypoints = std::move(stops);
    return make_motion(script, seed)->motion;  // a trolley follows any waypoints
}

void make_demo_stairs(ScriptedScene& out, std::uint64_t seed) {
    using namespace demo_stairs;
    const int tiles = material(out.scene, Pattern::tiles, 0.5, 0.6, 0.002);
    const int ground = material(out.scene, Pattern::patches, 0.35, 0.6, 0.002);
    const Pit pit{{{kPitMin_x_m, kPitMin_y_m}, {kPitMax_x_m, kPitMax_y_m}}, kPitDepth_m};
    out.scene.add_floor(Floor(room_area(), 0.0, {pit}), tiles, ground);
    add_demo_stairs(out.scene);
    add_demo_ramp(out.scene);
    add_table(
        out.scene, {{kTableMin_x_m, kTableMin_y_m}, {kTableMax_x_m, kTableMax_y_m}}, kTableTop_m);
    add_walls(out.scene, 0.0);
    out.motion = trolley({{0.0, 0.0, 0.0, 1.0},
                          {1.0, 0.0, 0.0, 0.2},
                          {1.0, 0.0, deg(15.0), 0.2},
                          {1.0, 0.0, -deg(15.0), 0.2},
                          {1.2, 0.0, 0.0, 0.2},
                          {kPathEnd_x_m, 0.0, 0.0, 0.5}},
                         seed);
}

void make_floor(ScriptedScene& out, std::uint64_t seed) {
    const int carpet = material(out.scene, Pattern::carpet, 0.4, 0.7, 0.002);
    out.scene.add_floor(Floor(room_area(), 0.0), carpet, carpet);
    add_walls(out.scene, 0.0);
    out.motion = trolley({{0.0, 0.0, 0.0, 1.0}, {1.5, 0.0, 0.0, 0.5}}, seed);
}

void make_platform_edge(ScriptedScene& out, std::uint64_t seed) {
    using namespace platform_edge;
    const Rect area = room_area();
    const int concrete = material(out.scene, Pattern::concrete, 0.45, 0.7, 0.002);
    const int ground = material(out.scene, Pattern::patches, 0.35, 0.6, 0.002);
    const double length_m = kEdge_x_m - area.min_m.x();
    out.scene.add(make_box({area.min_m.x() + 0.5 * length_m, 0.0},
                           {length_m, area.max_m.y() - area.min_m.y()},
                           -kHeight_m,
                           0.0),
                  concrete,
                  Label::floor);
    out.scene.add(Floor(area, -kHeight_m), ground, Label::drop);
    add_walls(out.scene, -kHeight_m);
    out.motion = trolley({{0.0, 0.0, 0.0, 1.0}, {kPathEnd_x_m, 0.0, 0.0, 0.5}}, seed);
}

void make_table(ScriptedScene& out, std::uint64_t seed) {
    const int carpet = material(out.scene, Pattern::carpet, 0.4, 0.7, 0.002);
    out.scene.add_floor(Floor(room_area(), 0.0), carpet, carpet);
    add_table(out.scene, {{2.2, -0.7}, {3.0, 0.7}}, 0.72);
    add_walls(out.scene, 0.0);
    out.motion = trolley({{0.0, 0.0, 0.0, 1.0}, {1.75, 0.0, 0.0, 0.5}}, seed);
}

struct Entry {
    const char* name;
    const char* description;
    void (*build)(ScriptedScene&, std::uint64_t);
};

constexpr std::array<Entry, 4> kScenes{{
    {"demo_stairs",
     "flat floor with a 3-step stair (0.18 m rise, 0.31 m going), a 1:8 ramp, a table and a pit; "
     "trolley drives 2.4 m towards the stair and looks round",
     make_demo_stairs},
    {"floor", "nothing but flat floor; trolley drives 1.5 m ahead", make_floor},
    {"platform_edge",
     "platform that ends 0.17 m above the floor; trolley stops 0.45 m before the edge",
     make_platform_edge},
    {"table", "table straight ahead, 0.72 m high; trolley stops 0.45 m before it", make_table},
}};

}  // namespace

std::vector<SceneInfo> list_scenes() {
    std::vector<SceneInfo> scenes;
    scenes.reserve(kScenes.size());
    for (const Entry& entry : kScenes) scenes.push_back({entry.name, entry.description});
    return scenes;
}

Result<ScriptedScene> make_scene(const std::string& name, std::uint64_t seed) {
    for (const Entry& entry : kScenes) {
        if (name != entry.name) continue;
        ScriptedScene scene;
        scene.info = {entry.name, entry.description};
        entry.build(scene, seed);
        return scene;
    }
    std::string names;
    for (const Entry& entry : kScenes)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", entry.name);
    return usage_error(
        fmt::format("simulator: no scene is named '{}'; there are: {}", name, names));
}

}  // namespace surefoot::sim
