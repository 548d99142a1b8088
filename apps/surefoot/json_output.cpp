// SPDX-License-Identifier: Apache-2.0
// nlohmann-json adds six seconds of compile time to a translation unit, so only the few files that
// write or read JSON include it.
#include "apps/surefoot/json_output.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/surefoot/ground_box.hpp"
#include "apps/surefoot/run_output.hpp"
#include "apps/surefoot/stairs_json.hpp"
#include "apps/surefoot/suite_rows.hpp"
#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/protocol/verdict_json.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {
namespace {

// Keys keep the order in which they are written, so the same run gives the same bytes.
using wire::Json;
using wire::number;

constexpr double kDegPerRad = 180.0 / M_PI;

Json counts_json(const FusionCounts& f) {
    return {{"points", f.points},
            {"gated_range", f.gated_range},
            {"gated_height", f.gated_height},
            {"gated_confidence", f.gated_confidence},
            {"gated_density", f.gated_density},
            {"gated_border", f.gated_border},
            {"outside", f.outside},
            {"cells_measured", f.cells_measured},
            {"cells_new", f.cells_new},
            {"cells_fused", f.cells_fused},
            {"cells_inflated", f.cells_inflated},
            {"cells_cleared", f.cells_cleared}};
}

Json summary_json(const wire::AuditSummary& summary) {
    Json damage = nullptr;
    if (summary.damage) {
        damage = {
            {"file", summary.damage->file},
            {"offset", summary.damage->offset},
            {"frame", summary.damage->sequence ? Json(*summary.damage->sequence) : Json(nullptr)},
            {"what", summary.damage->what}};
    }
    return {{"files", summary.files},
            {"bytes", summary.bytes},
            {"runs", summary.runs},
            {"verdicts", summary.verdicts},
            {"gaps", summary.gaps},
            {"lost", summary.lost},
            {"acts", summary.acts},
            {"unfinished", summary.unfinished},
            {"damage", damage}};
}

Json elevation_json(const eval::ElevationErrors& e) {
    return {{"median_abs_m", number(e.median_abs_m)},
            {"p90_abs_m", number(e.p90_abs_m)},
            {"mean_m", number(e.mean_m)},
            {"rmse_m", number(e.rmse_m)},
            {"share_over_50mm", number(e.share_over_50mm)},
            {"count", e.count}};
}

Json traversability_json(const eval::TraversabilityErrors& t) {
    return {{"false_safe", number(t.false_safe)},
            {"false_unsafe", number(t.false_unsafe)},
            {"true_safe", number(t.true_safe)},
            {"true_unsafe", number(t.true_unsafe)},
            {"unknown", number(t.unknown)}};
}

Json errors_json(const eval::TrajectoryErrors& e) {
    return {{"ate_rmse_m", number(e.ate_rmse_m)},
            {"rpe_trans_rmse_m", number(e.rpe_trans_rmse_m)},
            {"rpe_rot_rmse_deg", number(e.rpe_rot_rmse_deg)},
            {"drift_percent", number(e.drift_percent)},
            {"matched", e.matched},
            {"path_length_m", number(e.path_length_m)}};
}

Json figures_json(const eval::ErrorFigures& e, const std::string& unit) {
    return {{"median_abs_" + unit, number(e.median_abs)},
            {"p90_abs_" + unit, number(e.p90_abs)},
            {"p99_abs_" + unit, number(e.p99_abs)},
            {"max_abs_" + unit, number(e.max_abs)},
            {"mean_" + unit, number(e.mean)},
            {"rmse_" + unit, number(e.rmse)},
            {"count", e.count}};
}

/// Errors [m] per bin; the limits of the bins are in `key_unit`.
Json bins_json(const std::vector<eval::ErrorBin>& bins, const std::string& key_unit) {
    Json list = Json::array();
    for (const eval::ErrorBin& bin : bins) {
        Json entry = {{"from_" + key_unit, bin.from}, {"to_" + key_unit, bin.to}};
        entry.update(figures_json(bin.errors, "m"));
        list.push_back(std::move(entry));
    }
    return list;
}

Json sigma_json(const eval::SigmaCoverage& s) {
    return {{"within_1_sigma", number(s.within_1_sigma)},
            {"within_2_sigma", number(s.within_2_sigma)},
            {"within_3_sigma", number(s.within_3_sigma)},
            {"count", s.count}};
}

/// x y z qx qy qz qw
Json pose_json(const Pose& T) {
    const Eigen::Vector3d& t = T.translation_m;
    const Eigen::Quaterniond& q = T.rotation;
    return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json camera_json(const camera::RectifiedRig& rig) {
    return {{"width", rig.width},
            {"height", rig.height},
            {"focal_px", {rig.fx_px, rig.fy_px}},
            {"principal_px", {rig.cx_px, rig.cy_px}},
            {"baseline_m", rig.baseline_m},
            {"T_body_camera", pose_json(rig.T_body_camera)}};
}

/// The `count` numbers of a list; nullopt if the list is missing or has another size or content.
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

Json maps_object(const eval::MapComparison& result) {
    Json edges = figures_json(result.edges, "m");
    edges["by_column"] = bins_json(result.edges_by_column, "px");
    return {{"elevation", elevation_json(result.elevation)},
            {"elevation_away_from_edges", elevation_json(result.elevation_away_from_edges)},
            {"traversability", traversability_json(result.traversability)},
            {"coverage", number(result.coverage)},
            {"sigma", sigma_json(result.sigma)},
            {"by_distance", bins_json(result.by_distance, "m")},
            {"by_range", bins_json(result.by_range, "m")},
            {"by_column", bins_json(result.by_column, "px")},
            {"edges", edges},
            {"floor",
             {{"spread_m", number(result.floor.spread_m)},
              {"rms_m", number(result.floor.rms_m)},
              {"p99_abs_m", number(result.floor.p99_abs_m)},
              {"tilt_deg", number(result.floor.tilt_deg)},
              {"count", result.floor.count}}}};
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
                       {"doubtful_share", number(d.doubtful_share)}};
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
            {"frames_per_s", frame.median > 0.0 ? number(1e3 / frame.median) : Json(nullptr)},
            {"wall_s", record.wall_s},
            {"peak_memory_mb", peak_memory_mb()}};
}

Json health_json(const RunRecord& record) {
    int counts[3] = {};
    for (const FrameReport& frame : record.frames) ++counts[static_cast<int>(frame.motion.health)];
    return {{"OK", counts[0]}, {"DEGRADED", counts[1]}, {"LOST", counts[2]}};
}

Json arrivals_json(const ArrivalCounts& counts) {
    return {{"repeated_frames", counts.repeated_frames},
            {"longest_freeze_frames", counts.longest_freeze_frames},
            {"torn_frames", counts.torn_frames},
            {"dropped_frames", counts.dropped_frames},
            {"skipped_frames", counts.skipped_frames},
            {"damaged_frames", counts.damaged_frames},
            {"reconnections", counts.reconnections}};
}

Json trim_json(const std::optional<stereo::PairTrim>& trim) {
    if (!trim) return nullptr;
    return {{"roll_rad", number(trim->eye.roll_rad)},
            {"pitch_rad", number(trim->eye.pitch_rad)},
            {"focal_share", number(trim->eye.focal_share)},
            {"sigma", {number(trim->sigma[0]), number(trim->sigma[1]), number(trim->sigma[2])}},
            {"corners", trim->corners},
            {"row_error_px", number(trim->row_error_px)},
            {"row_error_left_px", number(trim->row_error_left_px)}};
}

Json place_json(const PlaceRecord& place) {
    Json refusals = Json::object();
    for (int i = 1; i < places::kRefusals; ++i)  // index 0 is Refusal::none
        refusals[to_string(static_cast<places::Refusal>(i))] =
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

void add_broken(const camera::BrokenFrames& broken, Json& object) {
    object["broken_frames"] = broken.count;
    object["first_broken"] = broken.count > 0 ? Json(broken.first) : Json(nullptr);
}

Json source_json(const camera::SourceInfo& source) {
    Json modelled = Json::array();
    if (source.modelled_motion) modelled.push_back("odometry");
    if (source.modelled_depth) modelled.push_back("depth");
    Json object = {{"kind", source.kind},
                   {"path", source.path},
                   {"modelled", modelled},
                   {"announced_frames", source.frames ? Json(*source.frames) : Json(nullptr)},
                   {"notes", source.notes}};
    add_broken(source.broken, object);
    return object;
}

/// Why a run is incomplete: it ended early, or its results could not be written; else null.
Json error_json(const RunRecord& record, const Status& written) {
    if (record.error) return record.error->message;
    return written ? Json(nullptr) : Json(written.error().message);
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
                   {"trim", trim_json(pipeline.trim())},
                   {"health", health_json(record)},
                   {"counts", counts_json(record.fusion)},
                   {"arrivals", arrivals_json(record.arrivals)},
                   {"camera", camera_json(pipeline.rig())},
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

Json frame_json(const FrameReport& frame) {
    return {{"index", frame.index},
            {"time_ns", frame.time_ns},
            {"health", to_string(frame.motion.health)},
            {"reason", to_string(frame.motion.reason)},
            {"tracks", frame.motion.tracks},
            {"inliers", frame.motion.inliers},
            {"residual_px", number(frame.motion.residual_px)},
            {"depth_pixels", frame.depth_pixels},
            {"known_cells", frame.known_cells},
            {"ground_accepted", frame.ground.accepted},
            {"camera", to_string(frame.camera)},
            {"repeated", frame.arrival.repeated},
            {"torn", frame.arrival.torn},
            {"dropped", frame.arrival.dropped},
            {"skipped", frame.arrival.skipped},
            {"damaged", frame.arrival.damaged},
            {"reconnected", frame.arrival.reconnected},
            {"counts", counts_json(frame.fusion)}};
}

constexpr int kIndent = 2;

Json event_json(const RexLinkRow& row) {
    using rex_link::LinkEventKind;
    const rex_link::LinkEvent& event = row.event;
    Json object = {{"time_s", seconds_from_ns(event.time_ns)}, {"event", to_string(event.kind)}};
    switch (event.kind) {
        case LinkEventKind::connected: break;
        case LinkEventKind::disconnected:
        case LinkEventKind::damaged: object["text"] = event.text; break;
        case LinkEventKind::joystick: object["command"] = event.command; break;
        case LinkEventKind::question:
            object["sequence"] = event.sequence;
            object["command"] = event.command;
            break;
        case LinkEventKind::answer:
            object["sequence"] = event.sequence;
            object["command"] = event.command;
            object["verdict"] = to_string(event.verdict);
            object["text"] = event.text;
            break;
        case LinkEventKind::inhibited: object["reason"] = to_string(event.inhibit); break;
        case LinkEventKind::tone:
            object["tone"] = to_string(event.tone);
            object["file"] = row.tone_file.empty() ? Json(nullptr) : Json(row.tone_file);
            break;
        case LinkEventKind::motion:
            object["command"] = event.command;
            object["duration_s"] = seconds_from_ns(event.duration_ns);
            break;
    }
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
    return object.dump(kIndent);
}

std::string run_json(const RunRecord& record,
                     const pipeline::Pipeline& pipeline,
                     const Status& written) {
    return run_object(record, pipeline, written).dump(kIndent);
}

std::string failure_json(const std::string& error, int exit_code) {
    return Json{{"error", error}, {"exit_code", exit_code}}.dump(kIndent);
}

std::string verdict_json(const gate::Verdict& verdict,
                         const std::string& text,
                         const std::vector<std::string>& assumed) {
    const gate::Evidence& e = verdict.evidence;
    Json evidence = {
        {"primary", to_string(verdict.primary)},
        {"worst_cell_m",
         e.has_worst_cell ? Json{kTenthMm_m * static_cast<double>(e.worst_x_tenth_mm),
                                 kTenthMm_m * static_cast<double>(e.worst_y_tenth_mm)}
                          : Json(nullptr)},
        {"value_m", kTenthMm_m * static_cast<double>(e.value_tenth_mm)},
        {"limit_m", kTenthMm_m * static_cast<double>(e.limit_tenth_mm)},
        {"stance_height_m",
         e.stance_known ? Json(kTenthMm_m * static_cast<double>(e.stance_height_tenth_mm))
                        : Json(nullptr)},
        {"height_delta_m", kTenthMm_m * static_cast<double>(e.height_delta_tenth_mm)},
        {"max_tilt_deg", number(std::atan(std::sqrt(e.max_tilt_tan_sq)) * kDegPerRad)},
        {"max_patch_sigma_m", number(kTenthMm_m * std::sqrt(e.max_patch_sigma_sq_tenth_mm2))},
        {"max_drift_m", kTenthMm_m * static_cast<double>(e.max_drift_tenth_mm)},
        {"cells", e.cells},
        {"known_cells", e.known_cells},
        {"vouched_cells", e.vouched_cells}};
    const Json object = {{"verdict", to_string(verdict.decision)},
                         {"reasons", wire::reasons_array(verdict.reasons)},
                         {"text", text},
                         {"evidence", evidence},
                         {"assumed", assumed},
                         {"command", verdict.command},
                         {"map_version", verdict.map_version},
                         {"config_hash", fmt::format("{:016x}", verdict.config_hash)}};
    return object.dump(kIndent);
}

std::string audit_json(const wire::AuditSummary& summary) {
    return summary_json(summary).dump(kIndent);
}

std::string audit_acts_json(const wire::AuditSummary& summary, const std::vector<wire::Act>& acts) {
    Json object = summary_json(summary);
    Json list = Json::array();
    for (const wire::Act& act : acts) {
        list.push_back({{"time_ns", act.time_ns},
                        {"act", to_string(act.kind)},
                        {"outcome", to_string(act.outcome)},
                        {"role", to_string(act.role)},
                        {"connection", act.connection},
                        {"radius_m", kTenthMm_m * act.radius_tenth_mm},
                        {"left_out", act.left_out},
                        {"text", act.text}});
    }
    object["list"] = list;
    return object.dump(kIndent);
}

std::string audit_replay_json(const wire::AuditSummary& summary, const AuditReplay& replay) {
    Json object = summary_json(summary);
    object["equal"] = replay.equal;
    object["different"] = replay.different;
    Json first = nullptr;
    if (replay.first) {
        Json fields = Json::array();
        for (const wire::FieldDifference& d : replay.first->fields)
            fields.push_back(
                {{"field", d.field}, {"recorded", d.recorded}, {"replayed", d.replayed}});
        first = {{"file", replay.first->file},
                 {"offset", replay.first->offset},
                 {"frame", replay.first->sequence},
                 {"fields", fields}};
    }
    object["first_difference"] = first;
    return object.dump(kIndent);
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

namespace {

/// Summary of a trajectory file.
Json trajectory_file_json(const io::TrajectoryFile& file) {
    return {{"format", file.format},
            {"stamps", file.stamps},
            {"poses", file.poses.size()},
            {"repeated", file.repeated},
            {"not_finite", file.not_finite},
            {"sorted", file.sorted}};
}

}  // namespace

std::string trajectory_json(const eval::TrajectoryErrors& errors,
                            const std::vector<eval::PathError>& by_length,
                            const io::TrajectoryFile& estimate,
                            const io::TrajectoryFile& truth) {
    Json list = Json::array();
    for (const eval::PathError& error : by_length) {
        list.push_back({{"length_m", error.length_m},
                        {"trans_rmse_m", number(error.trans_rmse_m)},
                        {"rot_rmse_deg", number(error.rot_rmse_deg)},
                        {"trans_percent", number(error.trans_percent)},
                        {"count", error.count}});
    }
    Json object = errors_json(errors);
    object["rpe_by_length"] = list;
    object["estimate"] = trajectory_file_json(estimate);
    object["truth"] = trajectory_file_json(truth);
    return object.dump(kIndent);
}

std::string maps_json(const eval::MapComparison& result) {
    return maps_object(result).dump(kIndent);
}

std::string depth_json(const eval::DepthErrors& errors, const TruthScale& scale) {
    const Json object = {
        {"bad_0_5_percent", number(errors.bad.over_0_5_percent)},
        {"bad_1_percent", number(errors.bad.over_1_percent)},
        {"bad_2_percent", number(errors.bad.over_2_percent)},
        {"density_percent", number(errors.density_percent)},
        {"auc", number(errors.sparsification.auc)},
        {"known_bad_0_5_percent", number(errors.known_bad.over_0_5_percent)},
        {"known_bad_1_percent", number(errors.known_bad.over_1_percent)},
        {"known_bad_2_percent", number(errors.known_bad.over_2_percent)},
        {"pixels", errors.counted},
        {"error", figures_json(errors.known, "px")},
        {"sigma", sigma_json(errors.coverage)},
        {"sparsification",
         {{"area_px", number(errors.sparsification.area)},
          {"oracle_area_px", number(errors.sparsification.oracle_area)},
          {"random_area_px", number(errors.sparsification.random_area)},
          {"count", errors.sparsification.count}}},
        {"scale",
         {{"used", scale.used},
          {"truth_over_estimate", number(errors.truth_over_estimate)},
          {"suspected", scale.suspected ? Json(*scale.suspected) : Json(nullptr)}}}};
    return object.dump(kIndent);
}

std::string measured_depth_json(const MeasuredPair& measured, const std::string& folder) {
    const PairFigures figures = figures_of(measured.depth);
    const stereo::PairCheck& check = measured.check;
    const double unknown = std::nan("");
    const Json rows = {{"corners", check.corners},
                       {"matched", check.matched},
                       {"median_abs_px", number(check.enough() ? check.row_error_px : unknown)},
                       {"median_px", number(check.enough() ? check.row_offset_px : unknown)}};
    const Json answer = {{"width", measured.depth.disparity_px.width()},
                         {"height", measured.depth.disparity_px.height()},
                         {"density_percent", number(figures.density_percent)},
                         {"trusted_percent", number(figures.trusted_percent)},
                         {"median_sigma_px", number(figures.median_sigma_px)},
                         {"row_error", rows},
                         {"camera", measured.rig ? camera_json(*measured.rig) : Json(nullptr)},
                         {"folder", folder}};
    return answer.dump(kIndent);
}

std::string depth_accuracy_json(const std::string& rig,
                                const std::vector<DistanceAccuracy>& rows,
                                const std::string& folder) {
    Json list = Json::array();
    for (const DistanceAccuracy& row : rows) {
        const double unknown = std::nan("");
        const auto error = [&](double eval::BoardErrors::*figure) {
            return number(row.errors ? *row.errors.*figure : unknown);
        };
        Json entry = {{"distance_m", row.distance_m},
                      {"looks", row.looks},
                      {"density_percent", number(row.density_percent)},
                      {"axial_m", error(&eval::BoardErrors::axial_m)},
                      {"std_m", error(&eval::BoardErrors::std_m)},
                      {"scale_share", error(&eval::BoardErrors::scale_share)}};
        entry["thesis"] = row.thesis ? Json{{"camera", row.thesis->camera},
                                            {"axial_m", row.thesis->axial_m},
                                            {"std_m", row.thesis->std_m}}
                                     : Json(nullptr);
        list.push_back(std::move(entry));
    }
    return Json{{"rig", rig}, {"distances", list}, {"folder", folder}}.dump(kIndent);
}

std::string depth_design_json(const eval::DepthDesign& design,
                              const std::vector<eval::ResolvableHeight>& rows,
                              const std::string& folder) {
    Json list = Json::array();
    for (const eval::ResolvableHeight& row : rows) {
        list.push_back({{"range_m", row.range_m},
                        {"in_view", row.in_view},
                        {"depth_m", number(row.depth_m)},
                        {"sigma_depth_m", number(row.sigma_depth_m)},
                        {"noise_limit_m", number(row.noise_limit_m)},
                        {"pixel_limit_m", number(row.pixel_limit_m)},
                        {"height_m", number(row.height_m)}});
    }
    const Json answer = {{"baseline_m", design.baseline_m},
                         {"focal_px", design.focal_px},
                         {"width", design.width},
                         {"height", design.height},
                         {"sigma_px", design.sigma_px},
                         {"camera_height_m", design.camera_height_m},
                         {"pitch_deg", design.pitch_deg},
                         {"nearest_floor_m", number(eval::nearest_floor_m(design))},
                         {"ranges", list},
                         {"folder", folder}};
    return answer.dump(kIndent);
}

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

std::string settings_json(const std::vector<io::ConfigEntry>& entries) {
    Json list = Json::array();
    for (const auto& entry : entries) {
        list.push_back({{"key", entry.key},
                        {"value", entry.value},
                        {"range", entry.range},
                        {"comment", entry.comment}});
    }
    return Json{{"settings", list}}.dump(kIndent);
}

std::string scenes_json(const std::vector<sim::SceneInfo>& scenes) {
    Json list = Json::array();
    for (const auto& scene : scenes)
        list.push_back({{"name", scene.name}, {"description", scene.description}});
    return Json{{"scenes", list}}.dump(kIndent);
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
    return object.dump(kIndent);
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
    return object.dump(kIndent);
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
    return object.dump(kIndent);
}

std::string copied_json(const Copied& copied, const std::string& folder) {
    Json object = {{"frames", copied.frames},
                   {"complete", !copied.error.has_value()},
                   {"error", copied.error ? Json(copied.error->message) : Json(nullptr)},
                   {"folder", folder}};
    add_broken(copied.broken, object);
    return object.dump(kIndent);
}

std::string rendered_boards_json(std::size_t views, const std::string& folder) {
    const Json object = {{"views", views}, {"folder", folder}};
    return object.dump(kIndent);
}

std::string scan_json(const Scanned& scanned) {
    const Json object = {{"points", scanned.points},
                         {"stations", scanned.stations},
                         {"tiles", scanned.tiles},
                         {"complete", !scanned.error.has_value()},
                         {"error", scanned.error ? Json(scanned.error->message) : Json(nullptr)},
                         {"file", scanned.file}};
    return object.dump(kIndent);
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
    return object.dump(kIndent);
}

std::string serve_json(const std::vector<AskedStep>& steps) {
    Json list = Json::array();
    for (const AskedStep& step : steps) {
        list.push_back({{"command", step.command},
                        {"moved", step.moved},
                        {"verdict", step.verdict},
                        {"text", step.text}});
    }
    return Json{{"movements", list}}.dump(kIndent);
}

std::string rex_link_json(const std::string& url, const std::vector<RexLinkRow>& rows) {
    Json list = Json::array();
    for (const RexLinkRow& row : rows) list.push_back(event_json(row));
    const auto count = [&rows](rex_link::LinkEventKind kind) {
        return std::count_if(rows.begin(), rows.end(), [kind](const RexLinkRow& row) {
            return row.event.kind == kind;
        });
    };
    const Json object = {{"url", url},
                         {"connections", count(rex_link::LinkEventKind::connected)},
                         {"questions", count(rex_link::LinkEventKind::question)},
                         {"motions", count(rex_link::LinkEventKind::motion)},
                         {"inhibited", count(rex_link::LinkEventKind::inhibited)},
                         {"events", list}};
    return object.dump(kIndent);
}

std::string rate_json(const grid::GridGeometry& geometry, const std::string& folder) {
    const Json object = {{"width", geometry.nx},
                         {"height", geometry.ny},
                         {"resolution_m", geometry.resolution_m},
                         {"folder", folder}};
    return object.dump(kIndent);
}

namespace {

Json region_json(const grid::MapRegion& region) {
    const Eigen::Vector2d origin_m = region.geometry().origin_m;
    return {{"width", region.box.nx},
            {"height", region.box.ny},
            {"resolution_m", region.resolution_m},
            {"origin_m", {origin_m.x(), origin_m.y()}},
            {"known_cells", region.known_cells()}};
}

}  // namespace

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
          {"focal_px", view.focal_px},
          {"baseline_m", view.baseline_m}}},
        {"disparity_sigma_px", view.disparity_sigma_px},
        {"depth_sigma", depths},
        {"floor", {{"near_m", number(view.floor.near_m)}, {"far_m", number(view.floor.far_m)}}},
        {"steps", steps},
        {"cameras", nodes}};
    return object.dump(kIndent);
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
    return object.dump(kIndent);
}

std::string check_json(const std::string& problem) {
    const Json object = {{"valid", problem.empty()},
                         {"problem", problem.empty() ? Json(nullptr) : Json(problem)}};
    return object.dump(kIndent);
}

namespace {

Json suite_figures_json(const std::vector<double>& figures) {
    Json object = Json::object();
    for (std::size_t i = 0; i < figures.size(); ++i)
        object[suite_figures()[i].name] = number(figures[i]);
    return object;
}

Json suite_steps_json(const std::vector<SuiteStep>& steps) {
    Json list = Json::array();
    for (const SuiteStep& step : steps) {
        list.push_back({{"step", step.number},
                        {"time_s", step.time_s},
                        {"command", step.command},
                        {"safe", step.safe},
                        {"clear_cut", step.clear_cut},
                        {"dangers", step.dangers},
                        {"decision", step.decision},
                        {"reasons", step.reasons}});
    }
    return list;
}

Json suite_tallies_json(const VerdictTallies& tallies) {
    Json list = Json::array();
    for (const VerdictTally& tally : tallies.all()) {
        list.push_back({{"by", kTallyKeyNames[static_cast<std::size_t>(tally.by)]},
                        {"name", tally.name},
                        {"named", tally.named},
                        {"alone", tally.alone}});
    }
    return list;
}

Json suite_bins_json(const std::vector<NoiseBins>& levels) {
    Json list = Json::array();
    for (const NoiseBins& level : levels) {
        for (const SuiteBin& bin : level.bins) {
            const std::string unit = unit_of(bin.key);
            list.push_back({{"noise", level.noise},
                            {"cases", level.cases},
                            {"by", kBinKeyNames[static_cast<std::size_t>(bin.key)]},
                            {"from_" + unit, bin.from},
                            {"to_" + unit, bin.to},
                            {"count", bin.errors.count()},
                            {"median_abs_m", number(bin.errors.percentile(0.5))},
                            {"p90_abs_m", number(bin.errors.percentile(0.9))},
                            {"p99_abs_m", number(bin.errors.percentile(0.99))}});
        }
    }
    return list;
}

}  // namespace

std::string suite_json(std::span<const SuiteResult> results) {
    Json cases = Json::array();
    for (const SuiteResult& result : results) {
        cases.push_back({{"scene", result.which.scene},
                         {"seed", result.which.seed},
                         {"noise", result.which.noise},
                         {"max_frames", result.which.max_frames},
                         {"carrier", result.which.carrier},
                         {"rate_hz", result.which.rate_hz},
                         {"figures", suite_figures_json(result.figures)},
                         {"steps", suite_steps_json(result.steps)},
                         {"wrong_answers", suite_tallies_json(result.tallies)}});
    }
    const auto rows_json = [](const std::vector<SuiteRow>& rows, bool by_scene) {
        Json list = Json::array();
        for (const SuiteRow& row : rows) {
            Json object = {{"carrier", row.carrier},
                           {"noise", row.noise},
                           {"cases", row.cases},
                           {"median", suite_figures_json(row.median)},
                           {"worst", suite_figures_json(row.worst)}};
            if (by_scene) object["scene"] = row.scene;
            list.push_back(std::move(object));
        }
        return list;
    };
    return Json{{"cases", cases},
                {"scenes", rows_json(summarise(results), true)},
                {"carriers", rows_json(summarise_by_carrier(results), false)},
                {"bins", suite_bins_json(pooled_by_noise(results))}}
        .dump(kIndent);
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
    return Json{{"benchmarks", list}}.dump(kIndent);
}

}  // namespace surefoot::app
