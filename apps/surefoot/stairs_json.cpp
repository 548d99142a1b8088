// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/stairs_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace surefoot::app {
namespace {

// Keys keep the order in which they are written: the same map gives the same bytes.
using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json point_json(const Eigen::Vector2d& p_m) {
    return {number(p_m.x()), number(p_m.y())};
}

Json pose_json(const stairs::FeaturePose& pose) {
    return {number(pose.p_m.x()), number(pose.p_m.y()), number(pose.p_m.z()), number(pose.yaw_rad)};
}

Json flight_json(const stairs::Flight& flight) {
    return {{"kind", flight.kind == stairs::FlightKind::up ? "up" : "down"},
            {"steps", flight.steps},
            {"riser_m", number(flight.riser_m)},
            {"riser_std_m", number(flight.riser_sigma_m)},
            {"riser_spread_m", number(flight.riser_spread_m)},
            {"going_m", number(flight.going_m)},
            {"going_std_m", number(flight.going_sigma_m)},
            {"going_spread_m", number(flight.going_spread_m)},
            {"width_m", number(flight.width_m)},
            {"landing_m", number(flight.landing_m)},
            {"turn_rad", number(flight.turn_rad)},
            {"cut", flight.cut},
            {"open", flight.open},
            {"pose", pose_json(flight.pose)}};
}

Json line_json(const stairs::LineFeature& line) {
    return {{"pose", pose_json(line.pose)},
            {"height_m", number(std::abs(line.height_m))},
            {"length_m", number(line.length_m)},
            {"sigma_m", number(line.sigma_m)},
            {"bottom_seen", line.bottom_seen}};
}

Json kerb_json(const stairs::LineFeature& kerb) {
    Json json = {{"kind", kerb.height_m < 0.0 ? "down" : "up"}};
    json.update(line_json(kerb));
    return json;
}

Json door_json(const stairs::Door& door) {
    return {{"width_m", number(door.width_m)},
            {"width_std_m", number(door.width_sigma_m)},
            {"sill_m", number(door.sill_m)},
            {"clearance_m", number(door.clearance_m)},
            {"pose", pose_json(door.pose)}};
}

Json edge_json(const stairs::Edge& edge) {
    return {{"from", point_json(edge.from_m)},
            {"to", point_json(edge.to_m)},
            {"upper_m", number(edge.upper_m)},
            {"lower_m", number(edge.lower_m)},
            {"lower_seen", edge.lower_seen},
            {"sigma_m", number(edge.height_sigma_m)}};
}

template <typename T>
Json list_json(const std::vector<T>& values, Json (*json_of)(const T&)) {
    Json list = Json::array();
    for (const T& value : values) list.push_back(json_of(value));
    return list;
}

Json classes_json(const stairs::GroundClasses& classes, double resolution_m) {
    const auto counts = stairs::count_classes(classes);
    Json json = Json::object();
    for (std::size_t i = 0; i < counts.size(); ++i)
        json[stairs::kGroundClassNames[i]] = {
            {"cells", counts[i]}, {"area_m2", number(counts[i] * resolution_m * resolution_m)}};
    return json;
}

}  // namespace

std::string stairs_json(const stairs::TerrainFeatures& features,
                        const stairs::GroundClasses& classes,
                        double resolution_m,
                        const std::vector<std::string>& assumed) {
    return Json{{"flights", list_json(features.flights, flight_json)},
                {"drops", list_json(features.drops, line_json)},
                {"kerbs", list_json(features.kerbs, kerb_json)},
                {"sills", list_json(features.sills, line_json)},
                {"doors", list_json(features.doors, door_json)},
                {"edges", list_json(features.edges, edge_json)},
                {"classes", classes_json(classes, resolution_m)},
                {"assumed", assumed}}
        .dump(2);
}

}  // namespace surefoot::app
