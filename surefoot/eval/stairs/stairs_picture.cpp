// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/stairs_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/maps/shown_part.hpp"

namespace surefoot::eval {
namespace {

using Eigen::Vector2d;
using stairs::Edge;
using stairs::Flight;
using stairs::FlightKind;
using stairs::LineFeature;

constexpr int kStep_px = 5;
constexpr int kDrop_px = 9;  ///< wide enough to be visible beside the first step of a flight down
constexpr int kThin_px = 3;
constexpr std::size_t kFlightsInKey = 4;
constexpr std::size_t kDoorsInKey = 4;

Vector2d direction(double yaw_rad) {
    return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

Rgb8 color_of(FlightKind kind) {
    return kind == FlightKind::up ? ground_palette::kUp : ground_palette::kDown;
}

/// Returns the name of a flight on the map: A, B, C, ...; empty for a single flight and after Z.
std::string name_of(std::size_t index, std::size_t count) {
    return count < 2 || index > 25 ? std::string() : std::string(1, static_cast<char>('A' + index));
}

/// Returns the line of a feature, directed so that the lower ground is on the right.
std::vector<Vector2d> line_of(const LineFeature& feature) {
    const Vector2d down = (feature.height_m < 0.0 ? 1.0 : -1.0) * direction(feature.pose.yaw_rad);
    const Vector2d half_m = 0.5 * feature.length_m * Vector2d(-down.y(), down.x());
    const Vector2d middle_m = feature.pose.p_m.head<2>();
    return {middle_m - half_m, middle_m + half_m};
}

/// Formats the range of the heights of lines: "drop: 0.18 to 0.50 m", "drop: 0.50 m or more".
std::string heights_text(const char* what, const std::vector<LineFeature>& lines) {
    double least_m = 1e9;
    double most_m = 0.0;
    bool all_seen = true;
    for (const LineFeature& line : lines) {
        least_m = std::min(least_m, std::abs(line.height_m));
        most_m = std::max(most_m, std::abs(line.height_m));
        all_seen = all_seen && line.bottom_seen;
    }
    const std::string least = fmt::format("{:.2f}", least_m);
    const std::string most = fmt::format("{:.2f}", most_m);
    return fmt::format("{}: {} m{}",
                       what,
                       least == most ? most : least + " to " + most,
                       all_seen ? "" : " or more");
}

void add_lines(const std::vector<LineFeature>& lines,
               const char* what,
               Rgb8 color,
               int width_px,
               Overlays& overlays) {
    if (lines.empty()) return;
    const std::string label = heights_text(what, lines);
    for (const LineFeature& line : lines) {
        overlays.strokes.push_back({.points_m = line_of(line),
                                    .color = color,
                                    .width_px = width_px,
                                    .label = label,
                                    .ticks = true});
    }
}

/// Returns the path along a flight, also along a flight with a turn. It leads from before the first
/// edge over the middles of all edges to behind the last edge.
std::vector<Vector2d> way_along(const Flight& flight) {
    constexpr double kBefore_m = 0.30;
    constexpr double kBehind_m = 0.20;
    const double before_m = flight.steps > 1 ? std::min(kBefore_m, flight.going_m) : kBefore_m;
    const double behind_m = std::min(kBehind_m, 0.5 * flight.landing_m);
    const Vector2d start_m = flight.pose.p_m.head<2>();
    std::vector<Vector2d> way{start_m - before_m * direction(flight.pose.yaw_rad)};
    for (const Edge& edge : flight.edges) way.push_back(edge.middle_m());
    const Vector2d end = direction(flight.pose.yaw_rad + flight.turn_rad);
    way.push_back((flight.edges.empty() ? start_m : way.back()) + behind_m * end);
    return way;
}

/// Adds the numbered steps of a flight and an arrow along it.
void add_flight(const Flight& flight,
                const std::string& name,
                const std::string& label,
                Overlays& overlays) {
    constexpr double kNumberAt = 0.14;  ///< share of the edge, from a walker's left end
    const Rgb8 color = color_of(flight.kind);
    int number = 0;
    for (const Edge& edge : flight.edges) {
        overlays.strokes.push_back({.points_m = {edge.from_m, edge.to_m},
                                    .color = color,
                                    .width_px = kStep_px,
                                    .label = label});
        // Along an edge the lower ground is on the right-hand side. For a person walking up, the
        // first end is therefore on the left.
        const bool up = flight.kind == FlightKind::up;
        const Vector2d left_m = up ? edge.from_m : edge.to_m;
        const Vector2d right_m = up ? edge.to_m : edge.from_m;
        overlays.badges.push_back(
            {left_m + kNumberAt * (right_m - left_m), std::to_string(++number), color});
    }
    const std::vector<Vector2d> way = way_along(flight);
    if (!name.empty()) overlays.badges.push_back({way.front(), name, palette::kInk});
    overlays.strokes.push_back(
        {.points_m = way, .color = palette::kInk, .width_px = kThin_px, .arrow = true});
}

void add_flights(const std::vector<Flight>& flights, Overlays& overlays) {
    for (std::size_t i = 0; i < flights.size(); ++i) {
        const std::string name = name_of(i, flights.size());
        std::string label = (name.empty() ? "" : name + ": ") + flight_text(flights[i]);
        if (i + 1 == kFlightsInKey && flights.size() > kFlightsInKey)
            label += fmt::format("\nand {} more flights", flights.size() - kFlightsInKey);
        add_flight(flights[i], name, i < kFlightsInKey ? label : "", overlays);
    }
}

/// Adds a line across the opening of each door, and a short line at each jamb.
void add_doors(const std::vector<stairs::Door>& doors, Overlays& overlays) {
    constexpr double kJamb_m = 0.08;
    constexpr int kJamb_px = 6;
    for (std::size_t i = 0; i < doors.size(); ++i) {
        const stairs::Door& door = doors[i];
        const Vector2d through = direction(door.pose.yaw_rad);
        const Vector2d half_m = 0.5 * door.width_m * Vector2d(-through.y(), through.x());
        const Vector2d jamb_m = kJamb_m * through;
        const Vector2d middle_m = door.pose.p_m.head<2>();
        Stroke across;
        across.points_m = {middle_m + half_m, middle_m - half_m};
        across.color = ground_palette::kDoor;
        if (i < kDoorsInKey)
            across.label =
                fmt::format("door: {} wide", length_text(door.width_m, door.width_sigma_m));
        overlays.strokes.push_back(across);
        for (const Vector2d& side_m : {Vector2d(middle_m + half_m), Vector2d(middle_m - half_m)}) {
            overlays.strokes.push_back({.points_m = {side_m - jamb_m, side_m + jamb_m},
                                        .color = ground_palette::kDoor,
                                        .width_px = kJamb_px});
        }
    }
}

/// Adds edges that belong to no flight, drop, kerb or sill.
void add_other_edges(const stairs::TerrainFeatures& features, Overlays& overlays) {
    const auto is_line = [](const Edge& edge, const std::vector<LineFeature>& lines) {
        return std::any_of(lines.begin(), lines.end(), [&](const LineFeature& line) {
            return line.pose.p_m.head<2>() == edge.middle_m();
        });
    };
    const auto is_step = [&](const Edge& edge) {
        return std::any_of(
            features.flights.begin(), features.flights.end(), [&](const Flight& flight) {
                return std::any_of(flight.edges.begin(), flight.edges.end(), [&](const Edge& step) {
                    return step.from_m == edge.from_m;
                });
            });
    };
    for (const Edge& edge : features.edges) {
        if (is_step(edge) || is_line(edge, features.drops) || is_line(edge, features.kerbs) ||
            is_line(edge, features.sills))
            continue;
        overlays.strokes.push_back({.points_m = {edge.from_m, edge.to_m},
                                    .color = ground_palette::kEdge,
                                    .width_px = kThin_px,
                                    .label = "other edge",
                                    .ticks = true});
    }
}

}  // namespace

std::string length_text(double length_m, double sigma_m) {
    if (!std::isfinite(length_m)) return "?";
    if (!std::isfinite(sigma_m)) return fmt::format("{:.0f} mm", 1e3 * length_m);
    const int decimals = sigma_m < 0.00095 ? 1 : 0;
    return fmt::format("{:.{}f} +- {:.{}f} mm", 1e3 * length_m, decimals, 1e3 * sigma_m, decimals);
}

std::string flight_text(const Flight& flight) {
    const char* kind = flight.kind == FlightKind::up ? "up" : "down";
    const std::string riser = length_text(flight.riser_m, flight.riser_sigma_m);
    if (flight.steps == 1)
        return fmt::format("{}, 1 step, {:.2f} m wide\n{}", kind, flight.width_m, riser);
    return fmt::format("{}, {} steps, {:.2f} m wide\n{} by {}",
                       kind,
                       flight.steps,
                       flight.width_m,
                       riser,
                       length_text(flight.going_m, flight.going_sigma_m));
}

Overlays with_features(const stairs::TerrainFeatures& features, Overlays overlays) {
    add_other_edges(features, overlays);
    add_lines(features.drops, "drop", ground_palette::kDrop, kDrop_px, overlays);
    add_lines(features.kerbs, "kerb", ground_palette::kKerb, kThin_px, overlays);
    add_lines(features.sills, "sill", ground_palette::kSill, kThin_px, overlays);
    add_doors(features.doors, overlays);
    add_flights(features.flights, overlays);
    return overlays;
}

Picture render_features(const grid::GridGeometry& geometry,
                        const grid::Layer& height_m,
                        const stairs::TerrainFeatures& features,
                        const Overlays& overlays,
                        const FigureText& text) {
    SUREFOOT_ASSERT(height_m.width() == geometry.nx && height_m.height() == geometry.ny);
    const ShownPart shown = shown_part(geometry, height_m, overlays);
    const grid::Layer part_m = shown.of(height_m, std::nanf(""));
    LayerStyle style = elevation_style();
    style.map = ColorMap::pale;
    style.hill_shading = false;  // the lines already mark steep ground
    style.text = text;
    return render_layer(shown.geometry, part_m, style, with_features(features, overlays));
}

}  // namespace surefoot::eval
