// SPDX-License-Identifier: Apache-2.0
#include "cli/json/recording_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "studies/runs/report_parts.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;

}  // namespace

std::string scenes_json(const std::vector<sim::SceneInfo>& scenes) {
    Json list = Json::array();
    for (const auto& scene : scenes)
        list.push_back({{"name", scene.name}, {"description", scene.description}});
    return dump_indented(Json{{"scenes", list}});
}

std::string recording_json(const io::RecordingInfo& info) {
    const auto optional = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
    const Json object = {
        {"kind", info.kind},
        {"frames", info.frames},
        {"announced_frames", optional(info.announced_frames)},
        {"incomplete", info.incomplete.empty() ? Json(nullptr) : Json(info.incomplete)},
        {"duration_s", info.duration_s},
        {"rate_hz", info.rate_hz},
        {"gaps", info.gaps},
        {"longest_gap_s", info.longest_gap_s},
        {"unpaired", info.unpaired},
        {"pair_tolerance_s", info.pair_tolerance_s},
        {"largest_pair_difference_s", info.largest_pair_difference_s},
        {"notes", info.notes},
        {"missing_images", info.missing_images},
        {"bad_stamps", info.bad_stamps},
        {"bytes", info.bytes},
        {"imu_samples", info.imu_samples},
        {"imu_rate_hz", info.imu_rate_hz},
        {"has_truth", info.has_truth},
        {"width", info.rig.left.width},
        {"height", info.rig.left.height},
        {"baseline_m", info.rig.T_left_right.translation_m.norm()}};
    return dump_indented(object);
}

std::string rig_json(const io::RigFile& file, const std::vector<std::string>& written) {
    const camera::StereoRig& rig = file.rig;
    const auto focal_px = [](const camera::Camera& camera) {
        return std::visit([](const auto& m) { return Json{m.fx_px, m.fy_px}; }, camera.model);
    };
    const Json object = {
        {"format", io::name_of(file.format)},
        {"width", rig.left.width},
        {"height", rig.left.height},
        {"focal_left_px", focal_px(rig.left)},
        {"focal_right_px", rig.right ? focal_px(*rig.right) : Json(nullptr)},
        {"baseline_m", rig.right ? Json(rig.T_left_right.translation_m.norm()) : Json(nullptr)},
        {"rectified", rig.rectified},
        {"notes", file.notes},
        {"written", written}};
    return dump_indented(object);
}

std::string copied_json(const Copied& copied, const std::string& folder) {
    Json object = {{"frames", copied.frames},
                   {"complete", !copied.error.has_value()},
                   {"error", copied.error ? Json(copied.error->message) : Json(nullptr)},
                   {"folder", folder}};
    add_broken(copied.broken, object);
    return dump_indented(object);
}

std::string rendered_boards_json(std::size_t views, const std::string& folder) {
    const Json object = {{"views", views}, {"folder", folder}};
    return dump_indented(object);
}

std::string replay_json(const std::vector<FrameReport>& frames,
                        double speed,
                        std::int64_t late,
                        const camera::SourceInfo& source) {
    Json list = Json::array();
    for (const FrameReport& frame : frames) list.push_back(frame_json(frame));
    const Json object = {{"source", source_json(source)},
                         {"frames", frames.size()},
                         {"late", late},
                         {"speed", speed},
                         {"per_frame", list}};
    return dump_indented(object);
}

std::string camera_view_json(const CameraView& view) {
    Json modes = Json::array();
    for (const io::VideoMode& mode : view.modes) {
        modes.push_back({{"format", mode.fourcc},
                         {"width", mode.width},
                         {"height", mode.height},
                         {"rate_hz", mode.rate_hz}});
    }
    Json controls = Json::array();
    for (const io::VideoControl& control : view.controls) {
        controls.push_back({{"name", control.name},
                            {"value", control.value ? Json(*control.value) : Json(nullptr)},
                            {"min", control.min},
                            {"max", control.max},
                            {"step", control.step},
                            {"writable", control.writable}});
    }
    const Json object = {{"kind", "live"},
                         {"device", view.device},
                         {"card", view.card},
                         {"driver", view.driver},
                         {"modes", modes},
                         {"controls", controls}};
    return dump_indented(object);
}

}  // namespace surefoot::app
