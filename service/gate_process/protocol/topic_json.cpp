// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/topic_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/verdict_json.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::gate_process {
namespace {

constexpr double kNsPerMs = 1e6;
constexpr int kArrowId = 0;
constexpr int kWordsId = 1;

const char* name_of(gate::GateState state) {
    switch (state) {
        case gate::GateState::init: return "INIT";
        case gate::GateState::warmup: return "WARMUP";
        case gate::GateState::ready: return "READY";
        case gate::GateState::degraded: return "DEGRADED";
        case gate::GateState::fault: return "FAULT";
        case gate::GateState::stopping: return "STOPPING";
    }
    return "FAULT";
}

/// Levels of diagnostic_msgs/DiagnosticStatus.
int level_of(gate::GateState state) {
    constexpr int kOk = 0;
    constexpr int kWarn = 1;
    constexpr int kError = 2;
    switch (state) {
        case gate::GateState::ready: return kOk;
        case gate::GateState::init:
        case gate::GateState::warmup:
        case gate::GateState::degraded: return kWarn;
        case gate::GateState::fault:
        case gate::GateState::stopping: return kError;
    }
    return kError;
}

Json age_ms(std::int64_t age_ns) {
    return age_ns < 0 ? Json(nullptr) : Json(static_cast<double>(age_ns) / kNsPerMs);
}

/// Returns the attested area in odom; null without a valid attestation.
Json attested_object(const gate::AttestedArea& area) {
    if (!area.active) return nullptr;
    constexpr double kTenthMm_m = 1e-4;
    return {{"x_m", static_cast<double>(area.center_x_tenth_mm) * kTenthMm_m},
            {"y_m", static_cast<double>(area.center_y_tenth_mm) * kTenthMm_m},
            {"z_m", static_cast<double>(area.height_tenth_mm) * kTenthMm_m},
            {"radius_m", static_cast<double>(area.radius_tenth_mm) * kTenthMm_m}};
}

Json stamp_object(std::int64_t time_ns) {
    return {{"secs", time_ns / kNanosecondsPerSecond}, {"nsecs", time_ns % kNanosecondsPerSecond}};
}

/// Returns every member of the health as text, as DiagnosticStatus requires.
Json key_values(const Json& health) {
    Json list = Json::array();
    for (const auto& [key, value] : health.items())
        list.push_back({{"key", key}, {"value", value.is_string() ? value : Json(dump(value))}});
    return list;
}

Json color_of(gate::Decision decision) {
    constexpr double kMax = 255.0;
    const auto color = [](int r, int g, int b) {
        return Json{{"r", r / kMax}, {"g", g / kMax}, {"b", b / kMax}, {"a", 1.0}};
    };
    switch (decision) {
        case gate::Decision::ok: return color(0, 158, 115);
        case gate::Decision::not_traversable: return color(213, 94, 0);
        case gate::Decision::error: break;
    }
    return color(204, 121, 167);
}

Json marker(int id, int type, int action) {
    return {// Viewers draw stamp 0 with the newest transform.
            {"header", {{"seq", 0}, {"stamp", stamp_object(0)}, {"frame_id", "odom"}}},
            {"ns", "surefoot_goal"},
            {"id", id},
            {"type", type},
            {"action", action},
            {"pose",
             {{"position", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
              {"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}}}}},
            {"scale", {{"x", 0.4}, {"y", 0.08}, {"z", 0.08}}},
            {"color", color_of(gate::Decision::error)},
            {"lifetime", stamp_object(0)},
            {"frame_locked", false},
            {"points", Json::array()},
            {"colors", Json::array()},
            {"text", ""},
            {"mesh_resource", ""},
            {"mesh_use_embedded_materials", false}};
}

std::array<Json, 2> both_markers(int action) {
    constexpr int kArrow = 0;  // visualization_msgs/Marker ARROW and TEXT_VIEW_FACING
    constexpr int kText = 9;
    return {marker(kArrowId, kArrow, action), marker(kWordsId, kText, action)};
}

}  // namespace

Json health_object(const GateReport& report) {
    return {{"state", name_of(report.health.state)},
            {"why", to_string(report.why)},
            {"faults", reasons_array(report.health.faults)},
            {"map_version", report.map_version},
            {"frame_age_ms", age_ms(report.frame_age_ns)},
            {"pose_age_ms", age_ms(report.pose_age_ns)},
            {"attesting", report.attestation},
            {"attested", attested_object(report.attested)},
            {"asked", report.asked},
            {"allowed", report.allowed}};
}

std::string health_text(const GateReport& report) {
    return dump(health_object(report));
}

Json diagnostics_object(const GateReport& report, std::int64_t now_ns) {
    const std::string state = name_of(report.health.state);
    const std::string why = to_string(report.why);
    const Json status = {{"level", level_of(report.health.state)},
                         {"name", "surefoot: step gate"},
                         {"message", report.why == gate::Reason::none ? state : state + ": " + why},
                         {"hardware_id", ""},
                         {"values", key_values(health_object(report))}};
    return {{"header", {{"seq", 0}, {"stamp", stamp_object(now_ns)}, {"frame_id", ""}}},
            {"status", Json::array({status})}};
}

Json outlook_object(const GateReport& report,
                    const StepGate& gate,
                    std::span<const Prospect> prospects) {
    Json verdicts = Json::array();
    for (const Prospect& prospect : prospects) {
        verdicts.push_back({{"command", prospect.verdict.command},
                            {"verdict", verdict_name(prospect.verdict)},
                            {"primary", to_string(prospect.verdict.primary)},
                            {"text", gate.words_of(prospect)}});
    }
    return {{"map_version", report.map_version},
            {"state", name_of(report.health.state)},
            {"verdicts", std::move(verdicts)}};
}

std::array<Json, 2> goal_markers(const GoalQuestion& goal, const Answer& answer) {
    constexpr int kAdd = 0;
    constexpr double kWordsHeight_m = 0.5;  // the text is above the arrow
    auto markers = both_markers(kAdd);
    const std::string words = std::string(to_string(answer.verdict.decision)) + ": " + answer.text;
    for (Json& one : markers) {
        one["header"]["frame_id"] = goal.frame_id;
        one["pose"]["position"]["x"] = goal.x_m;
        one["pose"]["position"]["y"] = goal.y_m;
        one["pose"]["orientation"]["z"] = std::sin(goal.yaw_rad / 2.0);
        one["pose"]["orientation"]["w"] = std::cos(goal.yaw_rad / 2.0);
        one["color"] = color_of(answer.verdict.decision);
        one["text"] = words;
    }
    markers[kWordsId]["pose"]["position"]["z"] = kWordsHeight_m;
    markers[kWordsId]["scale"]["z"] = 0.12;  // letter height
    return markers;
}

std::array<Json, 2> no_goal_markers() {
    constexpr int kDelete = 2;
    return both_markers(kDelete);
}

}  // namespace surefoot::gate_process
