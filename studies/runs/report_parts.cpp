// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/report_parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::app {
namespace {

using gate_process::Json;
using gate_process::number;

Json elevation_json(const eval::ElevationErrors& e) {
    return {{"median_abs_m", number(e.median_abs_m)},
            {"p90_abs_m", number(e.p90_abs_m)},
            {"mean_m", number(e.mean_m)},
            {"rmse_m", number(e.rmse_m)},
            {"share_over_50mm", number(e.share_over_50mm)},
            {"count", e.count}};
}

}  // namespace

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

/// Returns the errors [m] per bin. The limits of the bins have the unit of `key_unit`.
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

/// Returns the list x y z qx qy qz qw.
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

Json frame_json(const FrameReport& frame) {
    return {{"index", frame.index},
            {"time_ns", frame.time_ns},
            {"health", to_string(frame.motion.health)},
            {"reason", to_string(frame.motion.reason)},
            {"tracks", frame.motion.tracks},
            {"inliers", frame.motion.inliers},
            {"residual_px", number(frame.motion.residual_px)},
            {"depth_pixels", frame.depth_pixels},
            {"fine_pixels", frame.fine_pixels},
            {"known_cells", frame.known_cells},
            {"ground_accepted", frame.ground.accepted},
            {"camera", to_string(frame.camera)},
            {"repeated", frame.frame_status.repeated},
            {"torn", frame.frame_status.torn},
            {"dropped", frame.frame_status.dropped},
            {"skipped", frame.frame_status.skipped},
            {"damaged", frame.frame_status.damaged},
            {"reconnected", frame.frame_status.reconnected},
            {"counts", counts_json(frame.fusion)}};
}

}  // namespace surefoot::app
