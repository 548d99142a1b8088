// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_stations.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace surefoot::sim {
namespace {

constexpr double kReach_m = 200.0;
constexpr std::size_t kMaxStations = 100;

struct StationSpec {
    double x_m = kRequired;
    double y_m = kRequired;
    double above_m = kTripod_m;
    void describe(ConfigVisitor& visitor) {
        visitor.number("x_m", x_m, -kReach_m, kReach_m, "position of the scanner along x (ahead)");
        visitor.number("y_m", y_m, -kReach_m, kReach_m, "position of the scanner along y (left)");
        visitor.number("above_m",
                       above_m,
                       0.2,
                       10.0,
                       "height of the scanner over the highest surface below it");
    }
};

}  // namespace

bool is_buried(const Scene& scene, const Eigen::Vector3d& station_m) {
    if (scene.solid_at(station_m)) return true;
    const auto surfaces = scene.surfaces_at(station_m.x(), station_m.y());
    return !surfaces.empty() && station_m.z() < surfaces.back().z_m;
}

std::vector<Eigen::Vector3d> read_stations(SceneReader& reader,
                                           const SceneNode& group,
                                           const Scene& scene) {
    reader.only_keys(group, {"stations"});
    const SceneNode* list = reader.required(group, "stations", SceneNode::Kind::list);
    if (reader.error()) return {};
    if (list->items.empty() || list->items.size() > kMaxStations) {
        reader.fail(
            *list,
            fmt::format("has {} entries; 1 to {} are allowed", list->items.size(), kMaxStations));
    }
    std::vector<Eigen::Vector3d> stations_m;
    for (const SceneNode& item : list->items) {
        StationSpec spec;
        reader.read(item, spec);
        if (reader.error()) return {};
        const auto ground = scene.height_at(spec.x_m, spec.y_m);
        if (!ground) {
            reader.fail(
                item,
                fmt::format(
                    "at x {} m, y {} m there is no ground; move the scanner", spec.x_m, spec.y_m));
            return {};
        }
        stations_m.emplace_back(spec.x_m, spec.y_m, ground->z_m + spec.above_m);
    }
    return stations_m;
}

}  // namespace surefoot::sim
