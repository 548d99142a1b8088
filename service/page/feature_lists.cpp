// SPDX-License-Identifier: Apache-2.0
#include "service/page/feature_lists.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::page {
namespace {

using gate_process::Json;
using gate_process::number;

Json point_json(const Eigen::Vector2d& p_m) {
    return {number(p_m.x()), number(p_m.y())};
}

Json pose_json(const stairs::FeaturePose& pose) {
    return {number(pose.p_m.x()), number(pose.p_m.y()), number(pose.p_m.z()), number(pose.yaw_rad)};
}

/// Adds the tracking data of a tracked feature. `now_ns`: time of the newest observation of all
/// features.
Json tracked_json(Json json, const stairs::Tracked& tracked, std::int64_t now_ns) {
    if (tracked.id == 0) return json;
    json["id"] = tracked.id;
    json["observations"] = tracked.observations;
    json["last_seen_s"] = seconds_from_ns(now_ns - tracked.last_seen_ns);
    return json;
}

Json side_json(const stairs::FlightSide& side) {
    return {{"kind", to_string(side.kind)},
            {"rail_m", side.rail_m > 0.0 ? number(side.rail_m) : Json()}};
}

Json flight_json(const stairs::Flight& flight, std::int64_t now_ns) {
    const Json json = {{"kind", flight.kind == stairs::FlightKind::up ? "up" : "down"},
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
                       {"left", side_json(flight.left)},
                       {"right", side_json(flight.right)},
                       {"pose", pose_json(flight.pose)}};
    return tracked_json(json, flight.tracked, now_ns);
}

Json line_json(const stairs::LineFeature& line, std::int64_t now_ns) {
    const Json json = {{"pose", pose_json(line.pose)},
                       {"height_m", number(std::abs(line.height_m))},
                       {"length_m", number(line.length_m)},
                       {"sigma_m", number(line.sigma_m)},
                       {"bottom_seen", line.bottom_seen}};
    return tracked_json(json, line.tracked, now_ns);
}

Json kerb_json(const stairs::LineFeature& kerb, std::int64_t now_ns) {
    Json json = {{"kind", kerb.height_m < 0.0 ? "down" : "up"}};
    json.update(line_json(kerb, now_ns));
    return json;
}

Json door_json(const stairs::Door& door, std::int64_t now_ns) {
    const Json json = {{"width_m", number(door.width_m)},
                       {"width_std_m", number(door.width_sigma_m)},
                       {"sill_m", number(door.sill_m)},
                       {"clearance_m", number(door.clearance_m)},
                       {"pose", pose_json(door.pose)}};
    return tracked_json(json, door.tracked, now_ns);
}

Json edge_json(const stairs::Edge& edge, std::int64_t now_ns) {
    const Json json = {{"from", point_json(edge.from_m)},
                       {"to", point_json(edge.to_m)},
                       {"upper_m", number(edge.upper_m)},
                       {"lower_m", number(edge.lower_m)},
                       {"lower_seen", edge.lower_seen},
                       {"sigma_m", number(edge.height_sigma_m)}};
    return tracked_json(json, edge.tracked, now_ns);
}

template <typename T>
Json list_json(const std::vector<T>& values,
               std::int64_t now_ns,
               Json (*json_of)(const T&, std::int64_t)) {
    Json list = Json::array();
    for (const T& value : values) list.push_back(json_of(value, now_ns));
    return list;
}

/// Returns the lists with equal observation times, so that a comparison of two results ignores
/// time.
Json timeless_lists(stairs::TerrainFeatures features) {
    const auto seen_now = [&features](auto& list) {
        for (auto& feature : list) feature.tracked.last_seen_ns = features.time_ns;
    };
    seen_now(features.flights);
    seen_now(features.drops);
    seen_now(features.kerbs);
    seen_now(features.sills);
    seen_now(features.doors);
    seen_now(features.edges);
    return feature_lists(features);
}

}  // namespace

Json feature_lists(const stairs::TerrainFeatures& features) {
    return {{"flights", list_json(features.flights, features.time_ns, flight_json)},
            {"drops", list_json(features.drops, features.time_ns, line_json)},
            {"kerbs", list_json(features.kerbs, features.time_ns, kerb_json)},
            {"sills", list_json(features.sills, features.time_ns, line_json)},
            {"doors", list_json(features.doors, features.time_ns, door_json)},
            {"edges", list_json(features.edges, features.time_ns, edge_json)}};
}

std::string stairs_text(const stairs::TerrainFeatures& features) {
    Json json = {{"kind", "stairs"}, {"time_ns", features.time_ns}};
    json.update(feature_lists(features));
    return gate_process::dump(json);
}

bool say_the_same(const stairs::TerrainFeatures& one, const stairs::TerrainFeatures& other) {
    return timeless_lists(one) == timeless_lists(other);
}

}  // namespace surefoot::page
