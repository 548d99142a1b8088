// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/stairs_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "surefoot/eval/stairs/stairs_picture.hpp"

namespace surefoot::app {
namespace {

using eval::length_text;

/// One terrain feature as the cells of a table row.
struct Row {
    std::string what;
    std::string height;
    std::string going;
    std::string width;
    std::string place;
    std::string remarks;
};

std::string place_text(const stairs::FeaturePose& pose) {
    return fmt::format("({:.2f}, {:.2f}), {:.0f} deg",
                       pose.p_m.x(),
                       pose.p_m.y(),
                       pose.yaw_rad * 180.0 / std::numbers::pi);
}

std::string side_remark(const char* name, const stairs::FlightSide& side) {
    using stairs::SideKind;
    std::string text;
    if (side.kind != SideKind::unknown) {
        const char* const article = side.kind == SideKind::wall ? "a " : "";
        text = fmt::format("; {} {}{}", name, article, to_string(side.kind));
    }
    if (side.rail_m > 0.0)
        text += fmt::format("; rail on the {}, {:.2f} m high", name, side.rail_m);
    return text;
}

std::string flight_remarks(const stairs::Flight& flight) {
    std::string text = fmt::format("landing {:.2f} m", flight.landing_m);
    if (flight.steps > 2) {
        text += fmt::format("; single risers scatter by {:.0f} mm, goings by {:.0f} mm",
                            1e3 * flight.riser_spread_m,
                            1e3 * flight.going_spread_m);
    }
    constexpr double kStraight_rad = 0.1;
    if (std::abs(flight.turn_rad) > kStraight_rad)
        text += fmt::format("; turns by {:.0f} deg", flight.turn_rad * 180.0 / std::numbers::pi);
    if (flight.open) text += "; boards without risers";
    text += side_remark("left", flight.left) + side_remark("right", flight.right);
    if (flight.cut) text += "; may continue in unknown ground";
    return text;
}

Row flight_row(const stairs::Flight& flight) {
    return {fmt::format("{} {}, {} step{}",
                        flight.steps == 1 ? "step" : "flight",
                        flight.kind == stairs::FlightKind::up ? "up" : "down",
                        flight.steps,
                        flight.steps == 1 ? "" : "s"),
            length_text(flight.riser_m, flight.riser_sigma_m),
            flight.steps > 1 ? length_text(flight.going_m, flight.going_sigma_m) : "",
            fmt::format("{:.2f} m", flight.width_m),
            place_text(flight.pose),
            flight_remarks(flight)};
}

Row line_row(const char* what, const stairs::LineFeature& line) {
    return {
        what,
        length_text(std::abs(line.height_m), line.sigma_m) + (line.bottom_seen ? "" : " or more"),
        "",
        fmt::format("{:.2f} m", line.length_m),
        place_text(line.pose),
        line.bottom_seen ? "" : "the camera did not see the lower ground"};
}

Row door_row(const stairs::Door& door) {
    return {"door",
            "",
            "",
            length_text(door.width_m, door.width_sigma_m),
            place_text(door.pose),
            fmt::format("sill {}, {}",
                        length_text(door.sill_m, door.sill_sigma_m),
                        std::isfinite(door.clearance_m)
                            ? fmt::format("clear height {:.2f} m", door.clearance_m)
                            : "no ceiling seen above the door")};
}

std::vector<Row> rows_of(const stairs::TerrainFeatures& features) {
    std::vector<Row> rows;
    for (const stairs::Flight& flight : features.flights) rows.push_back(flight_row(flight));
    for (const stairs::LineFeature& drop : features.drops) rows.push_back(line_row("drop", drop));
    for (const stairs::LineFeature& kerb : features.kerbs)
        rows.push_back(line_row(kerb.height_m < 0.0 ? "kerb down" : "kerb up", kerb));
    for (const stairs::LineFeature& sill : features.sills) rows.push_back(line_row("sill", sill));
    for (const stairs::Door& door : features.doors) rows.push_back(door_row(door));
    return rows;
}

std::string count_text(std::size_t count, const char* what) {
    if (count == 0) return fmt::format("no {}", what);
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

std::string features_count_text(const stairs::TerrainFeatures& features) {
    return fmt::format("{}, {}, {}, {}, {}; {}",
                       count_text(features.flights.size(), "flight"),
                       count_text(features.drops.size(), "drop"),
                       count_text(features.kerbs.size(), "kerb"),
                       count_text(features.sills.size(), "sill"),
                       count_text(features.doors.size(), "door"),
                       count_text(features.edges.size(), "edge"));
}

std::string features_text(const stairs::TerrainFeatures& features) {
    std::string text;
    for (const Row& row : rows_of(features)) {
        text += row.what + ":";
        if (!row.height.empty())
            text += " " + row.height + (row.going.empty() ? "" : " by " + row.going) + ",";
        text += fmt::format(" {} wide at {}{}{}\n",
                            row.width,
                            row.place,
                            row.remarks.empty() ? "" : "; ",
                            row.remarks);
    }
    return text;
}

eval::ReportTable features_table(const stairs::TerrainFeatures& features) {
    eval::ReportTable table;
    table.title = "Flights, drops, kerbs, sills and doors, seen from the position of the machine";
    table.header = {"feature",
                    "riser, height or depth",
                    "going",
                    "width",
                    "position, walking direction",
                    "remarks"};
    table.wide = true;
    for (const Row& row : rows_of(features))
        table.rows.push_back({row.what, row.height, row.going, row.width, row.place, row.remarks});
    table.hint =
        "Positions are x and y in m in odom; the walking direction is an angle from the x axis. "
        "Values after +- are one sigma. stairs.json has all values, and every edge.";
    return table;
}

}  // namespace surefoot::app
