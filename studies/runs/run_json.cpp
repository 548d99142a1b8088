// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "studies/runs/report_parts.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/runs/stairs_json.hpp"
#include "surefoot/core/angles.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

/// Returns the `count` numbers of a list; nullopt if the list is missing or has another size or
/// content.
std::optional<std::vector<double>> numbers_of(const Json& object,
                                              const char* name,
                                              std::size_t count) {
    const auto list = object.find(name);
    if (list == object.end() || !list->is_array() || list->size() != count) return std::nullopt;
    std::vector<double> numbers;
    for (const Json& entry : *list) {
        if (!entry.is_number()) return std::nullopt;
        numbers.push_back(entry.get<double>());
    }
    return numbers;
}

Json truth_json(const TruthFigures& t) {
    const DepthFigures& d = t.depth;
    Json object = maps_object(t.maps);
    object["coverage_within_2_5_m"] = number(t.coverage_within_2_5_m);
    object["traversability"] = traversability_json(t.traversability);
    object["trajectory"] = errors_json(t.trajectory);
    object["depth"] = {{"pixels", d.pixels},
                       {"within_1_sigma", number(d.within_1_sigma)},
                       {"within_3_sigma", number(d.within_3_sigma)},
                       {"median_abs_error_px", number(d.median_abs_error_px)},
                       {"sigma_at_1_m_m", number(d.sigma_at_1_m_m)},
                       {"sigma_at_2_m_m", number(d.sigma_at_2_m_m)},
                       {"outlier_share", number(d.outlier_share)}};
    return object;
}

Json timing_json(const RunRecord& record) {
    Json stages = Json::object();
    for (int i = 0; i < kStageCount; ++i) {
        const auto stage = static_cast<Stage>(i);
        const Percentiles p = stage_percentiles(record, stage);
        stages[to_string(stage)] = {{"median_ms", p.median}, {"p99_ms", p.p99}};
    }
    const Percentiles frame = frame_percentiles(record);
    return {{"stages", stages},
            {"frame_median_ms", frame.median},
            {"frame_p99_ms", frame.p99},
            // The mean, because fine frames take longer than the median.
            {"frames_per_s", frame.mean > 0.0 ? number(1e3 / frame.mean) : Json(nullptr)},
            {"wall_s", record.wall_s},
            {"peak_memory_mb", peak_memory_mb()}};
}

Json health_json(const RunRecord& record) {
    int counts[3] = {};
    for (const FrameReport& frame : record.frames) ++counts[static_cast<int>(frame.motion.health)];
    return {{"OK", counts[0]}, {"DEGRADED", counts[1]}, {"LOST", counts[2]}};
}

Json frame_status_json(const FrameStatusCounts& counts) {
    return {{"repeated_frames", counts.repeated_frames},
            {"longest_freeze_frames", counts.longest_freeze_frames},
            {"torn_frames", counts.torn_frames},
            {"dropped_frames", counts.dropped_frames},
            {"skipped_frames", counts.skipped_frames},
            {"damaged_frames", counts.damaged_frames},
            {"reconnections", counts.reconnections}};
}

Json self_calibration_json(const std::optional<stereo::RigSelfCalibration>& self_calibration) {
    if (!self_calibration) return nullptr;
    return {{"roll_rad", number(self_calibration->camera.roll_rad)},
            {"pitch_rad", number(self_calibration->camera.pitch_rad)},
            {"focal_share", number(self_calibration->camera.focal_share)},
            {"sigma",
             {number(self_calibration->sigma[0]),
              number(self_calibration->sigma[1]),
              number(self_calibration->sigma[2])}},
            {"corners", self_calibration->corners},
            {"row_error_px", number(self_calibration->row_error_px)},
            {"row_error_left_px", number(self_calibration->row_error_left_px)}};
}

Json place_json(const PlaceRecord& place) {
    Json refusals = Json::object();
    for (int i = 1; i < place_recognition::kRefusals; ++i)  // skips index 0, which is Refusal::none
        refusals[to_string(static_cast<place_recognition::Refusal>(i))] =
            place.refusals[static_cast<std::size_t>(i)];
    const std::string& reason = place.left_as_it_was;
    return {{"file", place.file},
            {"saved_keyframes", place.saved_keyframes},
            {"own_keyframes", place.own_keyframes},
            {"kept_keyframes", place.kept_keyframes},
            {"recognitions", place.refusals[0]},
            {"recognised_ns", place.recognised_ns ? Json(*place.recognised_ns) : Json(nullptr)},
            {"T_map_odom", place.T_map_odom ? pose_json(*place.T_map_odom) : Json(nullptr)},
            {"refusals", refusals},
            {"left_as_it_was", reason.empty() ? Json(nullptr) : Json(reason)}};
}

/// Returns why a run is incomplete: it ended early, or its results could not be written. Null = it
/// is complete.
Json error_json(const RunRecord& record, const Status& written) {
    if (record.error) return record.error->message;
    return written ? Json(nullptr) : Json(written.error().message);
}

Json fine_json(const RunRecord& record, const pipeline::Pipeline& pipeline) {
    const auto frames = std::count_if(record.frames.begin(),
                                      record.frames.end(),
                                      [](const FrameReport& f) { return f.fine_pixels > 0; });
    return {{"scale", pipeline.scale()}, {"frames", frames}};
}

Json run_object(const RunRecord& record,
                const pipeline::Pipeline& pipeline,
                const Status& written) {
    const pipeline::Alignment& alignment = pipeline.alignment();
    const auto& geometry = pipeline.map().geometry();
    Json object = {{"source", source_json(record.source)},
                   {"frames", record.frames.size()},
                   {"waited_frames", record.waited_frames},
                   {"complete", record.complete() && written.ok()},
                   {"error", error_json(record, written)},
                   {"gravity_source", gravity_name(alignment.gravity_source)},
                   {"gravity_reason", alignment.reason},
                   {"tilt_sigma_deg", number(alignment.tilt_sigma_rad * kDegPerRad)},
                   {"ground_height_m",
                    alignment.has_ground ? number(alignment.ground_height_m) : Json(nullptr)},
                   {"self_calibration", self_calibration_json(pipeline.self_calibration())},
                   {"health", health_json(record)},
                   {"counts", counts_json(record.fusion)},
                   {"frame_status", frame_status_json(record.frame_status)},
                   {"camera", camera_json(pipeline.rig())},
                   {"fine", fine_json(record, pipeline)},
                   {"map",
                    {{"known_cells", pipeline.map().known_cells()},
                     {"cells", geometry.nx * geometry.ny},
                     {"resolution_m", geometry.resolution_m},
                     {"reason", empty_map_reason(record, pipeline)}}}};
    if (!written) object["output_error"] = written.error().message;
    if (record.place) object["place"] = place_json(*record.place);
    if (record.truth) object["truth"] = truth_json(*record.truth);
    object["timing"] = timing_json(record);
    return object;
}

}  // namespace

std::string report_json(const RunRecord& record,
                        const pipeline::Pipeline& pipeline,
                        const Status& written) {
    Json object = run_object(record, pipeline, written);
    Json frames = Json::array();
    for (const FrameReport& frame : record.frames) frames.push_back(frame_json(frame));
    object["per_frame"] = frames;
    return dump_indented(object);
}

std::string run_json(const RunRecord& record,
                     const pipeline::Pipeline& pipeline,
                     const Status& written) {
    return dump_indented(run_object(record, pipeline, written));
}

double parse_report_tilt_sigma_rad(const std::string& report_json) {
    const Json report = Json::parse(report_json, nullptr, false);
    if (!report.is_object()) return std::numeric_limits<double>::quiet_NaN();
    if (!report.contains("tilt_sigma_deg")) return 0.0;
    const Json& sigma_deg = report["tilt_sigma_deg"];
    if (!sigma_deg.is_number()) return std::numeric_limits<double>::quiet_NaN();
    return sigma_deg.get<double>() / kDegPerRad;
}

std::optional<ReportCamera> parse_report_camera(const std::string& report_json) {
    const Json report = Json::parse(report_json, nullptr, false);
    if (!report.is_object() || !report.contains("camera") || !report["camera"].is_object())
        return std::nullopt;
    const Json& object = report["camera"];
    const auto focal_px = numbers_of(object, "focal_px", 2);
    const auto principal_px = numbers_of(object, "principal_px", 2);
    const auto pose = numbers_of(object, "T_body_camera", 7);
    const auto width = object.find("width");
    const auto height = object.find("height");
    const bool sized = width != object.end() && width->is_number_integer() &&
                       height != object.end() && height->is_number_integer();
    if (!sized || !focal_px || !principal_px || !pose) return std::nullopt;
    ReportCamera camera;
    camera.view = {width->get<int>(),
                   height->get<int>(),
                   (*focal_px)[0],
                   (*focal_px)[1],
                   (*principal_px)[0],
                   (*principal_px)[1]};
    camera.T_body_camera.translation_m = {(*pose)[0], (*pose)[1], (*pose)[2]};
    camera.T_body_camera.rotation =
        Eigen::Quaterniond((*pose)[6], (*pose)[3], (*pose)[4], (*pose)[5]);
    const bool whole = camera.view.width > 0 && camera.view.height > 0 &&
                       std::abs(camera.T_body_camera.rotation.norm() - 1.0) < 1e-6;
    return whole ? std::optional(camera) : std::nullopt;
}

}  // namespace surefoot::app
