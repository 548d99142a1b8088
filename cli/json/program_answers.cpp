// SPDX-License-Identifier: Apache-2.0
#include "cli/json/program_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

}  // namespace

std::string settings_json(const std::vector<io::ConfigEntry>& entries) {
    Json list = Json::array();
    for (const auto& entry : entries) {
        list.push_back({{"key", entry.key},
                        {"value", entry.value},
                        {"range", entry.range},
                        {"comment", entry.comment}});
    }
    return dump_indented(Json{{"settings", list}});
}

std::string urdf_json(const io::MachineModel& model, const std::string& file) {
    Json joints = Json::array();
    for (const io::ModelJoint* joint : model.moving_joints())
        joints.push_back({{"name", joint->name},
                          {"min_rad", joint->min_rad},
                          {"max_rad", joint->max_rad},
                          {"stand_rad", joint->stand_rad}});
    const Json object = {{"name", model.name},
                         {"links", model.links.size()},
                         {"joints", std::move(joints)},
                         {"file", file.empty() ? Json(nullptr) : Json(file)}};
    return dump_indented(object);
}

std::string doctor_json(const std::string& version,
                        int threads,
                        const std::string& machine,
                        const RigView& view,
                        const std::vector<CameraNode>& cameras) {
    Json nodes = Json::array();
    for (const CameraNode& node : cameras)
        nodes.push_back({{"device", node.device}, {"card", node.card}, {"problem", node.problem}});
    Json depths = Json::array();
    for (const auto& depth : view.depths)
        depths.push_back({{"z_m", depth.z_m}, {"sigma_m", depth.sigma_m}});
    Json steps = Json::array();
    for (const auto& step : view.steps) {
        steps.push_back({{"command", step.command},
                         {"name", step.name},
                         {"toe_m", step.toe_m},
                         {"remembered", step.remembered}});
    }
    const Json object = {
        {"version", version},
        {"threads", threads},
        {"machine", machine},
        {"rig",
         {{"name", view.name},
          {"width", view.width},
          {"height", view.height},
          {"coarse_width", view.coarse_width},
          {"coarse_height", view.coarse_height},
          {"focal_px", view.focal_px},
          {"baseline_m", view.baseline_m}}},
        {"disparity_sigma_px", view.disparity_sigma_px},
        {"depth_sigma", depths},
        {"floor", {{"near_m", number(view.floor.near_m)}, {"far_m", number(view.floor.far_m)}}},
        {"steps", steps},
        {"cameras", nodes}};
    return dump_indented(object);
}

std::string check_json(const std::string& problem) {
    const Json object = {{"valid", problem.empty()},
                         {"problem", problem.empty() ? Json(nullptr) : Json(problem)}};
    return dump_indented(object);
}

std::string bench_json(const std::vector<BenchResult>& results) {
    Json list = Json::array();
    const auto optional = [](const std::optional<double>& value) {
        return value ? Json(*value) : Json(nullptr);
    };
    for (const auto& result : results) {
        const Timing peer = result.peer.value_or(Timing{});
        list.push_back(
            {{"name", result.name},
             {"median_ms", result.ours.median_ms},
             {"p99_ms", result.ours.p99_ms},
             {"least_cpu_ms", optional(result.ours.least_cpu_ms)},
             {"median_cpu_ms", optional(result.ours.median_cpu_ms)},
             {"peer_ms", optional(result.peer ? std::optional(peer.median_ms) : std::nullopt)},
             {"peer_least_cpu_ms", optional(peer.least_cpu_ms)}});
    }
    return dump_indented(Json{{"benchmarks", list}});
}

}  // namespace surefoot::app
