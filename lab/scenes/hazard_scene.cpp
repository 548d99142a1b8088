// SPDX-License-Identifier: Apache-2.0
#include "lab/scenes/hazard_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"

namespace surefoot::experiments {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFar_m = 6.0;   ///< extent of the levels [m]
constexpr double kDeep_m = 2.0;  ///< thickness of the ground [m]
constexpr double kTrolleyHeight_m = 0.95;

/// Converts a value of the machine file to metres.
double metres(std::int32_t tenth_mm) {
    return 1e-4 * tenth_mm;
}

Vector2d turned(const Vector2d& v, double angle_rad) {
    return {std::cos(angle_rad) * v.x() - std::sin(angle_rad) * v.y(),
            std::sin(angle_rad) * v.x() + std::cos(angle_rad) * v.y()};
}

/// Returns the largest extent of a box along `n` after a movement, or at the current pose if
/// `movement` is nullptr.
double reach_m(const GroundBox& box, double grown_m, const Movement* movement, const Vector2d& n) {
    double farthest_m = -1e9;
    for (const int along : {-1, 1}) {
        for (const int across : {-1, 1}) {
            Vector2d corner(metres(box.center_x_tenth_mm) +
                                along * (0.5 * metres(box.length_tenth_mm) + grown_m),
                            metres(box.center_y_tenth_mm) +
                                across * (0.5 * metres(box.width_tenth_mm) + grown_m));
            if (movement != nullptr) {
                corner =
                    turned(corner, std::atan2(movement->sin_turn, movement->cos_turn)) +
                    Vector2d(metres(movement->forward_tenth_mm), metres(movement->left_tenth_mm));
            }
            farthest_m = std::max(farthest_m, corner.dot(n));
        }
    }
    return farthest_m;
}

/// Positions along the normal at which the hazard has an effect: from just outside the current
/// footprint to the farthest feet and body after the movement.
struct Reach {
    double feet_now_m = 0.0;
    double feet_then_m = 0.0;
    double body_now_m = 0.0;
    double body_then_m = 0.0;
};

Reach reach_of(const Machine& machine, const Movement& movement, const Vector2d& n) {
    const auto feet = [&](const Movement* when) {
        return std::max(reach_m(machine.left_foot, 0.0, when, n),
                        reach_m(machine.right_foot, 0.0, when, n));
    };
    const double sway_m = metres(machine.body.sway_tenth_mm);
    const auto body = [&](const Movement* when) {
        double farthest_m = -1e9;
        for (const BodyPart& part : machine.body.all())
            farthest_m = std::max(farthest_m, reach_m(part.box, sway_m, when, n));
        return farthest_m;
    };
    return {feet(nullptr), feet(&movement), body(nullptr), body(&movement)};
}

/// Builds solids in the frame of the machine (base_link = origin). The near border of the hazard is
/// at `at` along `n`.
class Builder {
  public:
    explicit Builder(const Vector2d& n) : n_(n), t_(-n.y(), n.x()) {}

    /// Adds a box from `from_m` to `to_m` along the normal and from `right_m` to `left_m` across
    /// it.
    void box(
        double from_m, double to_m, double right_m, double left_m, double bottom_m, double top_m) {
        Solid solid;
        solid.center_m = 0.5 * (from_m + to_m) * n_ + 0.5 * (left_m + right_m) * t_;
        solid.size_m = {to_m - from_m, left_m - right_m};
        solid.cos_yaw = n_.x();
        solid.sin_yaw = n_.y();
        solid.bottom_m = bottom_m;
        solid.top_m = top_m;
        solids.push_back(solid);
    }
    void column(double along_m, double across_m, double radius_m, double bottom_m, double top_m) {
        Solid solid;
        solid.round = true;
        solid.center_m = along_m * n_ + across_m * t_;
        solid.size_m = {2.0 * radius_m, 2.0 * radius_m};
        solid.bottom_m = bottom_m;
        solid.top_m = top_m;
        solids.push_back(solid);
    }
    void level(double from_m, double to_m, double top_m) {
        box(from_m, to_m, -kFar_m, kFar_m, top_m - kDeep_m, top_m);
    }

    /// Adds a flight that begins at `at_m`. Its levels go down or up, and each is `going_m` deep.
    /// The last level extends to the end of the scene.
    void flight(double at_m, double rise_m, double going_m, int steps) {
        level(-kFar_m, at_m, 0.0);
        for (int k = 1; k <= steps; ++k) {
            const double to_m = k < steps ? at_m + k * going_m : kFar_m;
            level(at_m + (k - 1) * going_m, to_m, k * rise_m);
        }
    }
    void hole(double at_m, double length_m, double middle_m, double width_m, double depth_m) {
        const double right_m = middle_m - 0.5 * width_m;
        const double left_m = middle_m + 0.5 * width_m;
        level(-kFar_m, at_m, 0.0);
        level(at_m + length_m, kFar_m, 0.0);
        box(at_m, at_m + length_m, -kFar_m, right_m, -kDeep_m, 0.0);
        box(at_m, at_m + length_m, left_m, kFar_m, -kDeep_m, 0.0);
        box(at_m, at_m + length_m, right_m, left_m, -kDeep_m - depth_m, -depth_m);
    }
    void table(double at_m, double length_m, double middle_m, double width_m, double top_m) {
        constexpr double kBoard_m = 0.03;
        constexpr double kLeg_m = 0.025;
        constexpr double kInset_m = 0.06;
        box(at_m,
            at_m + length_m,
            middle_m - 0.5 * width_m,
            middle_m + 0.5 * width_m,
            top_m - kBoard_m,
            top_m);
        for (const double along_m : {at_m + kInset_m, at_m + length_m - kInset_m}) {
            for (const int side : {-1, 1})
                column(along_m,
                       middle_m + side * (0.5 * width_m - kInset_m),
                       kLeg_m,
                       0.0,
                       top_m - kBoard_m);
        }
    }

    std::vector<Solid> solids;

  private:
    Vector2d n_;
    Vector2d t_;
};

/// Random values of one hazard. Every hazard draws all of them, so that a hazard and its harmless
/// relief share the other draws.
struct Draw {
    double share = 0.0;                ///< position within the allowed range, 0 to 1
    double across = 0.0;               ///< sideways position, -1 to 1
    double a = 0.0, b = 0.0, c = 0.0;  ///< sizes, 0 to 1
    double spare = 0.0;                ///< draw for a later size; using it changes no other draw
};

double between(double low, double high, double share) {
    return low + share * (high - low);
}

/// Position and relief of an added hazard. For a harmless scene, `low_m` sets the relief, which is
/// at most 10 mm.
struct Thing {
    double at_m = 0.0;
    double relief_m = 0.0;
};

Thing build(Hazard thing, const double* low_m, const Draw& draw, const Reach& reach, Builder& out) {
    // Farthest position at which a hazard has an effect. A drop: the end of the drop band. A low
    // hazard: the margin of the foot. A high hazard: the sway of the body.
    constexpr double kBand_m = 0.09;
    const auto place = [&](double from_m, double to_m) {
        return between(from_m, std::max(to_m, from_m + 0.02), draw.share);
    };
    const double down_m = place(reach.feet_now_m + 0.005, reach.feet_then_m + kBand_m);
    const double low_thing_m = place(reach.feet_now_m + 0.03, reach.feet_then_m + 0.01);
    const double high_m = place(reach.body_now_m - 0.02, reach.body_then_m - 0.01);
    const auto relief = [&](double from_m, double to_m) {
        return low_m != nullptr ? *low_m : between(from_m, to_m, draw.a);
    };
    switch (thing) {
        case Hazard::stairs_down: {
            const double rise_m = relief(0.12, 0.22);
            const int steps = low_m != nullptr ? 1 : 3 + static_cast<int>(5.0 * draw.b);
            out.flight(down_m, -rise_m, between(0.24, 0.34, draw.c), steps);
            return {down_m, -rise_m};
        }
        case Hazard::stairs_up: {
            const double rise_m = relief(0.12, 0.22);
            const int steps = low_m != nullptr ? 1 : 3 + static_cast<int>(5.0 * draw.b);
            out.flight(low_thing_m, rise_m, between(0.24, 0.34, draw.c), steps);
            return {low_thing_m, rise_m};
        }
        case Hazard::kerb: {
            const double rise_m = relief(0.04, 0.18);
            const bool down = draw.b < 0.5;
            out.flight(down ? down_m : low_thing_m, down ? -rise_m : rise_m, 1.0, 1);
            return {down ? down_m : low_thing_m, down ? -rise_m : rise_m};
        }
        case Hazard::hole: {
            const double depth_m = relief(0.06, 0.6);
            const double width_m = between(0.15, 0.8, draw.b);
            out.hole(down_m,
                     between(0.15, 0.8, draw.c),
                     0.5 * (width_m + 0.3) * draw.across,
                     width_m,
                     depth_m);
            return {down_m, -depth_m};
        }
        case Hazard::platform: {
            const double depth_m = relief(0.3, 1.2);
            out.level(-kFar_m, down_m, 0.0);
            if (low_m != nullptr || draw.b > 0.3) out.level(down_m, kFar_m, -depth_m);
            return {down_m, -depth_m};
        }
        case Hazard::wall: {
            const double height_m = relief(0.5, 2.6);
            const double width_m = between(0.2, 4.0, draw.b);
            const double middle_m = 0.5 * (width_m + 0.4) * draw.across;
            out.level(-kFar_m, kFar_m, 0.0);
            out.box(high_m,
                    high_m + between(0.05, 0.4, draw.c),
                    middle_m - 0.5 * width_m,
                    middle_m + 0.5 * width_m,
                    0.0,
                    height_m);
            return {high_m, height_m};
        }
        case Hazard::table: {
            const double top_m = between(0.5, 0.8, draw.a);
            const double width_m = between(0.4, 1.8, draw.b);
            const double length_m = between(0.4, 1.0, draw.c);
            const double middle_m = 0.5 * (width_m + 0.4) * draw.across;
            out.level(-kFar_m, kFar_m, 0.0);
            if (low_m != nullptr) {
                out.box(high_m,
                        high_m + length_m,
                        middle_m - 0.5 * width_m,
                        middle_m + 0.5 * width_m,
                        0.0,
                        *low_m);
                return {high_m, *low_m};
            }
            out.table(high_m, length_m, middle_m, width_m, top_m);
            return {high_m, top_m};
        }
        case Hazard::sill: {
            const double height_m = relief(0.04, 0.12);
            const double width_m = between(0.5, 4.0, draw.b);
            const double middle_m = 0.5 * width_m * draw.across;
            out.level(-kFar_m, kFar_m, 0.0);
            out.box(low_thing_m,
                    low_thing_m + between(0.03, 0.2, draw.c),
                    middle_m - 0.5 * width_m,
                    middle_m + 0.5 * width_m,
                    0.0,
                    height_m);
            return {low_thing_m, height_m};
        }
        case Hazard::person:
        case Hazard::unseen: break;
    }
    const double height_m = relief(1.2, 1.95);
    const double radius_m = between(0.10, 0.25, draw.b);
    out.level(-kFar_m, kFar_m, 0.0);
    out.column(high_m + radius_m, 0.5 * draw.across, radius_m, 0.0, height_m);
    return {high_m, height_m};
}

/// Draws a normal within 35 deg of the direction of the movement (of a random direction for a
/// turn). The normal never points against the walked path: the machine has walked there, so that
/// side is ground.
Vector2d normal_for(const Movement& movement, Vector2d& ahead, bool& was_turned, Rng& rng) {
    const Vector2d move_m(metres(movement.forward_tenth_mm), metres(movement.left_tenth_mm));
    const bool turns = move_m.norm() < 1e-3;
    const Vector2d towards =
        turns ? turned(Vector2d::UnitX(), rng.uniform(-std::numbers::pi, std::numbers::pi))
              : Vector2d(move_m.normalized());
    was_turned = towards.x() < -0.05;
    ahead = was_turned ? Vector2d(-Vector2d::UnitX()) : Vector2d(Vector2d::UnitX());
    for (;;) {
        Vector2d n = turned(towards, rng.uniform(-35.0, 35.0) / kDegPerRad);
        if (n.dot(ahead) >= 0.0) return n;
    }
}

void move_to(HazardScene& scene, const Vector2d& at_m, double yaw_rad) {
    const double c = std::cos(yaw_rad);
    const double s = std::sin(yaw_rad);
    for (Solid& solid : scene.solids) {
        solid.center_m = at_m + turned(solid.center_m, yaw_rad);
        const double cos_yaw = c * solid.cos_yaw - s * solid.sin_yaw;
        solid.sin_yaw = s * solid.cos_yaw + c * solid.sin_yaw;
        solid.cos_yaw = cos_yaw;
    }
    scene.edge_m = at_m + turned(scene.edge_m, yaw_rad);
    scene.normal = turned(scene.normal, yaw_rad);
    scene.yaw_rad = yaw_rad;
    scene.T_world_body.translation_m = {at_m.x(), at_m.y(), 0.0};
    scene.T_world_body.rotation = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ());
}

constexpr const char* kLooks[] = {"carpet", "tiles", "wood", "concrete", "patches"};

/// Returns the line of the scene file for a solid.
std::string solid_line(const Solid& solid, std::size_t index) {
    const double yaw_deg = kDegPerRad * std::atan2(solid.sin_yaw, solid.cos_yaw);
    const std::size_t look = index % std::size(kLooks);
    if (solid.round) {
        return fmt::format(
            "  - cylinder: {{x_m: {}, y_m: {}, radius_m: {}, bottom_m: {}, top_m: {}, material: "
            "m{}}}\n",
            solid.center_m.x(),
            solid.center_m.y(),
            0.5 * solid.size_m.x(),
            solid.bottom_m,
            solid.top_m,
            look);
    }
    return fmt::format(
        "  - box: {{x_m: {}, y_m: {}, heading_deg: {}, length_m: {}, width_m: {}, bottom_m: {}, "
        "top_m: {}, material: m{}}}\n",
        solid.center_m.x(),
        solid.center_m.y(),
        yaw_deg,
        solid.size_m.x(),
        solid.size_m.y(),
        solid.bottom_m,
        solid.top_m,
        look);
}

}  // namespace

bool Solid::covers(const Vector2d& p_m) const noexcept {
    const Vector2d d = p_m - center_m;
    if (round) return d.squaredNorm() <= 0.25 * size_m.x() * size_m.x();
    return std::abs(cos_yaw * d.x() + sin_yaw * d.y()) <= 0.5 * size_m.x() &&
           std::abs(cos_yaw * d.y() - sin_yaw * d.x()) <= 0.5 * size_m.y();
}

bool Solid::blocks(const Vector3d& from_m, const Vector3d& to_m) const noexcept {
    // Clips the line segment to the heights of the solid, then to its footprint.
    const Vector3d way = to_m - from_m;
    double first = 0.0;
    double last = 1.0;
    const auto cut = [&](double at, double speed, double low, double high) {
        if (std::abs(speed) < 1e-12) return at >= low && at <= high;
        const double a = (low - at) / speed;
        const double b = (high - at) / speed;
        first = std::max(first, std::min(a, b));
        last = std::min(last, std::max(a, b));
        return first < last;
    };
    if (!cut(from_m.z(), way.z(), bottom_m, top_m)) return false;
    const Vector2d d = from_m.head<2>() - center_m;
    if (!round) {
        return cut(cos_yaw * d.x() + sin_yaw * d.y(),
                   cos_yaw * way.x() + sin_yaw * way.y(),
                   -0.5 * size_m.x(),
                   0.5 * size_m.x()) &&
               cut(cos_yaw * d.y() - sin_yaw * d.x(),
                   cos_yaw * way.y() - sin_yaw * way.x(),
                   -0.5 * size_m.y(),
                   0.5 * size_m.y());
    }
    const Vector2d w = way.head<2>();
    const double nearest = std::clamp(-d.dot(w) / std::max(w.squaredNorm(), 1e-12), first, last);
    return (d + nearest * w).norm() < 0.5 * size_m.x();
}

sim::Scene HazardScene::scene() const {
    sim::Scene scene;
    for (const Solid& solid : solids) {
        const int material = scene.add_material({});
        if (solid.round) {
            scene.add(
                sim::Cylinder(solid.center_m, 0.5 * solid.size_m.x(), solid.bottom_m, solid.top_m),
                material,
                sim::Label::object);
        } else {
            scene.add(sim::make_box(solid.center_m,
                                    solid.size_m,
                                    solid.bottom_m,
                                    solid.top_m,
                                    std::atan2(solid.sin_yaw, solid.cos_yaw)),
                      material,
                      sim::Label::object);
        }
    }
    return scene;
}

std::string HazardScene::yaml() const {
    Rng rng(mix_seed(seed, 77));
    std::string text = fmt::format(
        "name: {}\ndescription: one movement into one hazard\nlighting: {{ambient: {}, lamp: "
        "{}}}\nmaterials:\n",
        kHazardNames[static_cast<int>(asked)],
        rng.uniform(0.35, 0.6),
        rng.uniform(0.2, 0.6));
    for (std::size_t k = 0; k < std::size(kLooks); ++k) {
        text += fmt::format("  m{}: {{pattern: {}, albedo: {}, contrast: {}}}\n",
                            k,
                            kLooks[rng.below(std::size(kLooks))],
                            rng.uniform(0.3, 0.6),
                            rng.uniform(0.45, 0.75));
    }
    text +=
        "  plaster: {pattern: plaster, albedo: 0.6, contrast: 0.45, texel_m: 0.005}\n"
        "  patches: {pattern: patches, albedo: 0.5, contrast: 0.6, texel_m: 0.006}\nsolids:\n";
    for (std::size_t i = 0; i < solids.size(); ++i) text += solid_line(solids[i], i);
    text +=
        "  - walls: {min_x_m: -3, min_y_m: -4, max_x_m: 6, max_y_m: 4, bottom_m: -2, material: "
        "patches, other_material: plaster}\n";
    text += "motion:\n  waypoints: [{x_m: 0, y_m: 0, pause_s: 0.5}";
    if (way_m > 0.0) text += fmt::format(", {{x_m: {}, y_m: 0, pause_s: 0.3}}", way_m);
    if (turned) text += fmt::format(", {{x_m: {}, y_m: 0, yaw_deg: 180, pause_s: 0.3}}", way_m);
    return text + "]\n";
}

HazardScene make_hazard_scene(
    Hazard kind, bool relief_only, std::uint64_t seed, const Machine& machine, Placing placing) {
    Rng rng(mix_seed(mix_seed(seed, static_cast<std::uint64_t>(kind)), relief_only ? 2 : 1));
    HazardScene scene;
    scene.seed = seed;
    scene.asked = scene.thing = kind;
    scene.relief_only = relief_only;
    while (scene.thing == Hazard::unseen) scene.thing = static_cast<Hazard>(rng.below(kHazards));
    do {
        scene.command = 1 + static_cast<int>(rng.below(Machine::kMovementCodes - 1));
    } while (!machine.movements[static_cast<std::size_t>(scene.command)].configured);
    const Movement& movement = machine.movements[static_cast<std::size_t>(scene.command)];

    Vector2d ahead;
    const Vector2d n = normal_for(movement, ahead, scene.turned, rng);
    scene.way_m = rng.uniform(1.3, 2.0);
    if (kind == Hazard::unseen) {
        scene.way_m = 0.0;
        scene.turned = false;
    }
    const Draw draw{rng.uniform(),
                    rng.uniform(-1.0, 1.0),
                    rng.uniform(),
                    rng.uniform(),
                    rng.uniform(),
                    rng.uniform()};
    const double low_m = rng.uniform(0.001, 0.010);
    Builder builder(n);
    const Thing thing = build(
        scene.thing, relief_only ? &low_m : nullptr, draw, reach_of(machine, movement, n), builder);
    scene.solids = std::move(builder.solids);
    scene.relief_m = thing.relief_m;
    scene.edge_m = thing.at_m * n;
    scene.normal = n;
    if (placing == Placing::anywhere) {
        move_to(scene,
                {rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)},
                rng.uniform(-std::numbers::pi, std::numbers::pi));
        scene.T_world_body.translation_m.z() = metres(machine.sole_depth_tenth_mm);
    } else {
        move_to(scene, {scene.way_m, 0.0}, scene.turned ? std::numbers::pi : 0.0);
        scene.T_world_body.translation_m.z() = kTrolleyHeight_m;
    }
    return scene;
}

}  // namespace surefoot::experiments
