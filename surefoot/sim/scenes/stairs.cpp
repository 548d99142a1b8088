// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/sim/scenes/solids.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

constexpr double kReach_m = 100.0;
constexpr int kMaxSteps = 200;
constexpr double kMinRise_m = 0.005;
constexpr double kMaxRise_m = 0.5;
/// Steps of one flight may differ by +-5 mm (NZ D1/AS1, Table 6 and its text).
constexpr double kMaxVariation_m = 0.005;

int or_same(int material, int own) {
    return material == kSameMaterial ? own : material;
}

/// One tread and its support, in the frame of the flight: x along the flight, z = 0 at its
/// beginning.
struct Tread {
    double begin_m = 0.0;
    double end_m = 0.0;
    double top_m = 0.0;
};

void add_block(
    Site& site, const FlightSpec& flight, const Place& place, const Tread& block, double bottom_m) {
    const double middle_m = 0.5 * (block.begin_m + block.end_m);
    site.scene.add(make_box(place.to_world({middle_m, 0.0}),
                            {block.end_m - block.begin_m, flight.width_m},
                            place.z_m + bottom_m,
                            place.z_m + block.top_m,
                            place.yaw_rad),
                   flight.material,
                   flight.label);
}

/// Adds a solid block, or a board with or without a block under it. The block is set back by the
/// nosing.
void add_tread(
    Site& site, const FlightSpec& flight, const Place& place, Tread tread, double bottom_m) {
    if (!flight.open && flight.nosing_m == 0.0) {
        return add_block(site, flight, place, tread, bottom_m);
    }
    // The nose points against the walking direction in an upward flight, and along it in a
    // downward flight.
    const bool up = flight.direction == StairDirection::up;
    Tread support = tread;
    (up ? support.begin_m : support.end_m) += up ? flight.nosing_m : -flight.nosing_m;
    // The board extends under the nose of the next higher tread, up to the riser there.
    (up ? tread.end_m : tread.begin_m) += up ? flight.nosing_m : -flight.nosing_m;
    const double under_m = tread.top_m - flight.tread_thickness_m;
    add_block(site, flight, place, tread, under_m);
    if (flight.open) return;
    (up ? support.end_m : support.begin_m) += up ? flight.nosing_m : -flight.nosing_m;
    support.top_m = under_m;
    if (under_m - bottom_m > 1e-6) add_block(site, flight, place, support, bottom_m);
}

/// Makes a wedge of a spiral as a convex prism. A chain of chords replaces its outer arc.
Prism wedge(const Vector2d& axis_m,
            const SpiralSpec& spiral,
            double from_rad,
            double to_rad,
            double bottom_m,
            double top_m) {
    constexpr int kChords = 6;  // at 1 m and 30 deg the chords are 1 mm off the arc
    const auto corner = [&](double radius_m, double angle_rad) -> Vector2d {
        return axis_m + radius_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    };
    const double low_rad = std::min(from_rad, to_rad);
    const double high_rad = std::max(from_rad, to_rad);
    std::vector<Vector2d> footprint_m;
    for (int k = 0; k <= kChords; ++k) {
        const double share = static_cast<double>(k) / kChords;
        footprint_m.push_back(
            corner(spiral.outer_radius_m, low_rad + share * (high_rad - low_rad)));
    }
    footprint_m.push_back(corner(spiral.inner_radius_m, high_rad));
    footprint_m.push_back(corner(spiral.inner_radius_m, low_rad));
    Prism::Top top;
    top.top_m = top_m;
    return {std::move(footprint_m), bottom_m, top};
}

}  // namespace

void FlightSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the flight");
    visitor.enumeration("label", label, kLabelNames, "class of the flight in the ground truth");
    visitor.number("x_m", x_m, -kReach_m, kReach_m, "x of the middle of the first edge");
    visitor.number("y_m", y_m, -kReach_m, kReach_m, "y of the middle of the first edge");
    visitor.number("z_m", z_m, -kReach_m, kReach_m, "height of the floor where the flight begins");
    visitor.number(
        "heading_deg",
        heading_deg,
        -360.0,
        360.0,
        "angle of the direction of travel along the flight: 0 = along +x, 90 = along +y");
    visitor.enumeration("direction",
                        direction,
                        kStairDirectionNames,
                        "whether the flight leads up or down along heading_deg");
    visitor.integer("steps", steps, 1, kMaxSteps, "number of rises of the flight");
    visitor.number("rise_m", rise_m, kMinRise_m, kMaxRise_m, "height of each rise");
    visitor.number("going_m", going_m, 0.05, 5.0, "depth of each tread, from nosing to nosing");
    visitor.number(
        "width_m", width_m, 0.1, kReach_m, "width of the flight, across the direction of travel");
    visitor.number("landing_m",
                   landing_m,
                   0.0,
                   kReach_m,
                   "depth of the landing at the end of the flight; 0 = no landing");
    visitor.number(
        "base_m", base_m, 0.0, kReach_m, "depth of the solid below the lower end of the flight");
    visitor.number("nosing_m", nosing_m, 0.0, 0.1, "overhang of a tread over its riser");
    visitor.number(
        "tread_thickness_m",
        tread_thickness_m,
        0.005,
        0.3,
        "thickness of a tread with a nosing or without a riser; smallest thickness of the "
        "landing of a flight that leads down");
    visitor.boolean("open", open, "true: the flight has no risers");
    visitor.number("rise_variation_m",
                   rise_variation_m,
                   0.0,
                   kMaxVariation_m,
                   "largest deviation of a rise from rise_m");
}

std::optional<std::string> FlightSpec::problem() const {
    if (steps < 1) return "key 'steps' is missing";
    if (direction == StairDirection::down && steps == 1 && landing_m == 0.0) {
        return "a flight of 1 step down without a landing has no tread; set landing_m, or more "
               "steps";
    }
    if (nosing_m >= going_m) {
        return fmt::format("nosing_m {} must be below going_m {}", nosing_m, going_m);
    }
    if ((open || nosing_m > 0.0) && tread_thickness_m > rise_m - rise_variation_m) {
        return fmt::format(
            "tread_thickness_m {} does not fit into rise_m {} minus rise_variation_m; make the "
            "tread thinner",
            tread_thickness_m,
            rise_m);
    }
    return std::nullopt;
}

void FlightSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, z_m, heading_deg);
    const bool up = direction == StairDirection::up;
    const double bottom_m = (up ? 0.0 : -steps * rise_m) - base_m;
    for (int step = 1; step <= steps; ++step) {
        const bool last = step == steps;
        if (last && !up && landing_m == 0.0) break;  // the floor below the flight follows
        Tread tread;
        tread.begin_m = (step - 1) * going_m;
        tread.end_m = tread.begin_m + (last && landing_m > 0.0 ? landing_m : going_m);
        tread.top_m = (up ? 1.0 : -1.0) * step * rise_m;
        // The rise between two neighbours deviates from `rise_m` by at most the variation. Both
        // ends of the flight are exact.
        if (!last && rise_variation_m > 0.0) {
            tread.top_m += 0.5 * site.rng.uniform(-rise_variation_m, rise_variation_m);
        }
        const bool lower_landing = last && !up;
        add_tread(site,
                  *this,
                  place,
                  tread,
                  lower_landing ? tread.top_m - std::max(base_m, tread_thickness_m) : bottom_m);
    }
}

void SpiralSpec::describe(ConfigVisitor& visitor) {
    visitor.choice("material", material, materials, "material of the spiral flight");
    visitor.choice("pole_material", pole_material, materials, "material of the pole");
    visitor.enumeration(
        "label", label, kLabelNames, "class of the spiral flight in the ground truth");
    visitor.number("x_m", x_m, -kReach_m, kReach_m, "x of the axis of the spiral flight");
    visitor.number("y_m", y_m, -kReach_m, kReach_m, "y of the axis of the spiral flight");
    visitor.number(
        "z_m", z_m, -kReach_m, kReach_m, "height of the floor where the spiral flight begins");
    visitor.number(
        "start_deg",
        start_deg,
        -360.0,
        360.0,
        "angle of the direction from the axis to the first edge: 0 = along +x, 90 = along +y");
    visitor.number("turn_deg",
                   turn_deg,
                   -60.0,
                   60.0,
                   "angle of one step about the axis, positive to the left");
    visitor.enumeration("direction",
                        direction,
                        kStairDirectionNames,
                        "whether the spiral flight leads up or down in the direction of turn_deg");
    visitor.integer("steps", steps, 1, kMaxSteps, "number of rises of the spiral flight");
    visitor.number("rise_m", rise_m, kMinRise_m, kMaxRise_m, "height of each rise");
    visitor.number("inner_radius_m",
                   inner_radius_m,
                   0.01,
                   20.0,
                   "distance from the axis to the inner end of the steps");
    visitor.number("outer_radius_m",
                   outer_radius_m,
                   0.1,
                   20.0,
                   "distance from the axis to the outer end of the steps");
    visitor.number(
        "thickness_m", thickness_m, 0.0, 0.5, "thickness of a step; 0 = solid down to the floor");
    visitor.number(
        "pole_height_m", pole_height_m, 0.0, 10.0, "height of the pole above z_m; 0 = no pole");
}

std::optional<std::string> SpiralSpec::problem() const {
    if (steps < 1) return "key 'steps' is missing";
    if (std::abs(turn_deg) < 1.0) {
        return fmt::format(
            "turn_deg {} is too small; a step must turn by at least 1 deg to the left or right",
            turn_deg);
    }
    if (outer_radius_m - inner_radius_m < 0.1) {
        return fmt::format("outer_radius_m {} must be at least 0.1 m above inner_radius_m {}",
                           outer_radius_m,
                           inner_radius_m);
    }
    if (steps * std::abs(turn_deg) > 360.0) {
        return fmt::format(
            "{} steps of {} deg go round more than once; use fewer steps or a smaller turn_deg",
            steps,
            turn_deg);
    }
    return std::nullopt;
}

void SpiralSpec::add(Site& site) const {
    const Place place = site.place.then(x_m, y_m, z_m, start_deg);
    const bool up = direction == StairDirection::up;
    const double floor_m = place.z_m + (up ? 0.0 : -steps * rise_m);
    const int treads = up ? steps : steps - 1;
    for (int step = 1; step <= treads; ++step) {
        const double top_m = place.z_m + (up ? 1.0 : -1.0) * step * rise_m;
        const double bottom_m =
            thickness_m > 0.0 ? std::max(top_m - thickness_m, floor_m) : floor_m;
        const double from_rad = place.yaw_rad + (step - 1) * turn_deg * kRadPerDeg;
        const double to_rad = from_rad + turn_deg * kRadPerDeg;
        site.scene.add(
            wedge(place.at_m, *this, from_rad, to_rad, bottom_m, top_m), material, label);
    }
    if (pole_height_m > 0.0) {
        site.scene.add(Cylinder(place.at_m, inner_radius_m, floor_m, place.z_m + pole_height_m),
                       or_same(pole_material, material),
                       Label::object);
    }
}

}  // namespace surefoot::sim
