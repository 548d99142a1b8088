// SPDX-License-Identifier: Apache-2.0
#include "cli/json/map_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/angles.hpp"

namespace surefoot::app {
namespace {

// This JSON type keeps the order of the keys, so the same run always gives the same bytes.
using gate_process::Json;
using gate_process::number;

constexpr int kIndent = 2;

Json region_json(const grid::MapRegion& region) {
    const Eigen::Vector2d origin_m = region.geometry().origin_m;
    return {{"width", region.box.nx},
            {"height", region.box.ny},
            {"resolution_m", region.resolution_m},
            {"origin_m", {origin_m.x(), origin_m.y()}},
            {"known_cells", region.known_cells()}};
}

}  // namespace

std::string dem_json(const grid::GridGeometry& geometry,
                     std::int64_t known_cells,
                     const eval::CloudBounds& bounds,
                     const std::string& file) {
    const Json object = {{"width", geometry.nx},
                         {"height", geometry.ny},
                         {"resolution_m", geometry.resolution_m},
                         {"origin_m", {geometry.origin_m.x(), geometry.origin_m.y()}},
                         {"known_cells", known_cells},
                         {"points", bounds.points()},
                         {"skipped", bounds.skipped()},
                         {"file", file}};
    return object.dump(kIndent);
}

std::string ground_json(const ground::GroundSighting& sighting) {
    const GroundObservation& o = sighting.observation;
    const bool known = sighting.uncertainty.height_var_m2 > 0.0;
    const Json object = {
        {"accepted", o.accepted},
        {"reason", to_string(sighting.reason)},
        {"tilt_deg", number(sighting.tilt_rad * kDegPerRad)},
        {"height_m", number(o.height_m)},
        {"inlier_ratio", number(o.inlier_ratio)},
        {"rms_m", number(o.rms_m)},
        {"tilt_sigma_deg",
         known ? number(sighting.uncertainty.tilt_sigma_rad() * kDegPerRad) : Json(nullptr)},
        {"height_sigma_m",
         known ? number(std::sqrt(sighting.uncertainty.height_var_m2)) : Json(nullptr)},
        {"normal", {number(o.normal.x()), number(o.normal.y()), number(o.normal.z())}}};
    return object.dump(kIndent);
}

std::string rate_json(const grid::GridGeometry& geometry, const std::string& folder) {
    const Json object = {{"width", geometry.nx},
                         {"height", geometry.ny},
                         {"resolution_m", geometry.resolution_m},
                         {"folder", folder}};
    return object.dump(kIndent);
}

std::string map_info_json(const io::MapFile& map, const std::string& file) {
    const grid::MapRegion& r = map.region;
    Json object = region_json(r);
    object["version"] = fmt::format("{}.{}", io::kMapFileMajor, map.minor);
    object["frame"] = r.frame;
    object["frame_since_ns"] = r.frame_since_ns;
    object["stamp_ns"] = r.stamp_ns;
    const Eigen::Vector3d& t = r.T_frame_body.translation_m;
    const Eigen::Quaterniond& q = r.T_frame_body.rotation;
    object["T_frame_body"] = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
    object["config_hash"] = fmt::format("{:016x}", r.config_hash);
    Json layers = Json::array();
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto, auto) {
        layers.push_back({{"name", layer.name}, {"unit", layer.unit}});
    });
    object["layers"] = layers;
    object["skipped_layers"] = map.skipped_layers;
    object["file"] = file;
    return object.dump(kIndent);
}

std::string map_merge_json(const grid::MapRegion& merged,
                           const elevation::MergeCounts& counts,
                           const std::string& file) {
    Json object = region_json(merged);
    object["taken"] = counts.taken;
    object["agreed"] = counts.agreed;
    object["disagreed"] = counts.disagreed;
    object["file"] = file;
    return object.dump(kIndent);
}

std::string map_export_json(const grid::MapRegion& region,
                            const std::vector<std::string>& files,
                            const std::string& folder) {
    Json object = region_json(region);
    object["files"] = files;
    object["folder"] = folder;
    return object.dump(kIndent);
}

std::string fuse_json(std::size_t steps, const std::string& folder) {
    return Json{{"steps", steps}, {"folder", folder}}.dump(kIndent);
}

}  // namespace surefoot::app
