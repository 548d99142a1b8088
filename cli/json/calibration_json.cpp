// SPDX-License-Identifier: Apache-2.0
#include "cli/json/calibration_json.hpp"

#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump;
using gate_process::dump_indented;
using gate_process::Json;

Json camera_fit_json(const CalibratedCamera& this_camera, calibration::LensKind kind) {
    Json parameters = Json::object();
    Json sigmas = Json::object();
    const auto names = calibration::parameter_names(kind);
    for (std::size_t i = 0; i < names.size(); ++i) {
        parameters[names[i]] = this_camera.parameters[static_cast<Eigen::Index>(i)];
        sigmas[names[i]] = this_camera.sigmas[static_cast<Eigen::Index>(i)];
    }
    return {
        {"name", this_camera.name},
        {"parameters", parameters},
        {"sigmas", sigmas},
        {"mapping_sigma_px",
         {{"median", this_camera.mapping.median_px}, {"largest", this_camera.mapping.largest_px}}}};
}

Json rejected_json(const CalibrationRun& run) {
    Json list = Json::array();
    for (const calibration::RejectedView& rejected : rejected_views(run)) {
        list.push_back(
            {{"view", run.views[rejected.index].name}, {"reason", why_left_out(run, rejected)}});
    }
    return list;
}

Json advice_json(const CalibrationRun& run) {
    Json list = Json::array();
    for (int camera = 0; camera < run.cameras(); ++camera) {
        for (const std::string& advice : run.coverage[static_cast<std::size_t>(camera)].advice)
            list.push_back(camera_name(run, camera) + ": " + advice);
    }
    return list;
}

void add_stereo(const calibration::StereoCalibration& stereo, Json& json) {
    json["row_rms_px"] = stereo.row_rms_px;
    json["row_focal_px"] = stereo.row_focal_px;
    json["rectified_focal_px"] = stereo.rectified_focal_px;
    json["baseline_m"] = stereo.rig.T_left_right.translation_m.norm();
    json["rotation_rad"] = log_so3(stereo.rig.T_left_right.rotation).norm();
    Json depth = Json::array();
    for (const calibration::DepthError& error : stereo.depth_errors)
        depth.push_back({{"distance_m", error.distance_m},
                         {"sigma_m", error.sigma_m}});  // the JSON library writes NaN as null
    json["depth_errors"] = depth;
}

Json points_json(const calibration::BoardView& view, const std::string& problem) {
    Json pixels = Json::array();
    for (const Eigen::Vector2d& pixel : view.pixels) pixels.push_back({pixel.x(), pixel.y()});
    return {{"problem", problem}, {"ids", view.ids}, {"pixels", pixels}};
}

}  // namespace

std::string calibration_json(const CalibrationRun& run) {
    const auto both_cameras = calibrated_cameras(run);
    Json cameras = Json::array();
    for (const CalibratedCamera& this_camera : both_cameras)
        cameras.push_back(camera_fit_json(this_camera, lens_kind(run)));
    Json json = {
        {"model", calibration::kLensKindNames[static_cast<std::size_t>(lens_kind(run))]},
        {"width", run.size.width},
        {"height", run.size.height},
        {"views", run.views.size()},
        {"used", both_cameras.front().views.size()},
        {"rms_px", run.stereo ? run.stereo->rms_px : run.mono->rms_px},
        {"sigma_px", run.stereo ? run.stereo->sigma_px : run.mono->sigma_px},
    };
    if (run.stereo) add_stereo(*run.stereo, json);
    json["cameras"] = cameras;
    json["rejected"] = rejected_json(run);
    json["advice"] = advice_json(run);
    json["notes"] = run.notes;
    return dump_indented(json);
}

std::string views_json(const CalibrationRun& run) {
    Json views = Json::array();
    for (const FoundView& view : run.views) {
        Json json = {{"name", view.name}, {"left", points_json(view.left, view.left_problem)}};
        if (run.cameras() == 2) json["right"] = points_json(view.right, view.right_problem);
        views.push_back(std::move(json));
    }
    return dump(Json{{"board", run.board_text},
                     {"width", run.size.width},
                     {"height", run.size.height},
                     {"views", views}}) +
           "\n";
}

}  // namespace surefoot::app
