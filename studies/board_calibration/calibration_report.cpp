// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/calibration_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "studies/board_calibration/calibration_pictures.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/eval/report/html_report.hpp"

namespace surefoot::app {
namespace {

constexpr double kMillimetres = 1e3;

void add_pictures(const CalibrationRun& run, eval::ReportContent& content) {
    if (run.stereo) {
        content.pictures.push_back(
            {fmt::format("{}, rectified with this calibration. A point must lie on the same line "
                         "in the left and in the right half.",
                         run.sample.name),
             eval::encode_png(epipolar_picture(run)),
             true});
    }
    for (int camera = 0; camera < run.cameras(); ++camera) {
        content.pictures.push_back({"Board points of all views in the image.",
                                    eval::encode_png(coverage_picture(run, camera))});
    }
    for (int camera = 0; camera < run.cameras(); ++camera) {
        content.pictures.push_back(
            {"Tilt of the board in every view.", eval::encode_png(tilt_picture(run, camera))});
    }
    for (const CalibratedCamera& this_camera : calibrated_cameras(run)) {
        content.pictures.push_back(
            {"Residual of every point. The residuals of a good calibration point in random "
             "directions. A pattern over the image means that the lens model does not fit the "
             "lens, or that the board is not flat.",
             eval::encode_png(residual_picture(run, this_camera))});
    }
}

void add_figures(const CalibrationRun& run, eval::ReportContent& content) {
    const double rms_px = run.stereo ? run.stereo->rms_px : run.mono->rms_px;
    const double sigma_px = run.stereo ? run.stereo->sigma_px : run.mono->sigma_px;
    content.figures.push_back({"Reprojection error",
                               fmt::format("{:.3f}", rms_px),
                               "px",
                               "root mean square distance, as OpenCV defines it"});
    content.figures.push_back({"Corner noise",
                               fmt::format("{:.3f}", sigma_px),
                               "px",
                               "one sigma of a corner coordinate in the image"});
    const std::size_t used = calibrated_cameras(run).front().views.size();
    content.figures.push_back({run.stereo ? "Pairs used" : "Views used",
                               std::to_string(used),
                               "",
                               fmt::format("of {}", run.views.size())});
    if (!run.stereo) return;
    const auto& stereo = *run.stereo;
    content.figures.push_back(
        {"Row error",
         fmt::format("{:.3f}", stereo.row_rms_px),
         "px",
         fmt::format("rms after rectification, scaled to the focal length of the lenses ({:.0f} "
                     "px); the focal length of the rectified images is {:.0f} px",
                     stereo.row_focal_px,
                     stereo.rectified_focal_px)});
    content.figures.push_back(
        {"Baseline",
         fmt::format("{:.2f}", kMillimetres * stereo.rig.T_left_right.translation_m.norm()),
         "mm",
         fmt::format("rotation between the cameras {:.2f} deg",
                     kDegPerRad * log_so3(stereo.rig.T_left_right.rotation).norm())});
}

eval::ReportTable depth_table(const calibration::StereoCalibration& stereo) {
    eval::ReportTable table;
    table.title = "Depth error of this calibration";
    table.header = {"distance [m]", "one sigma [mm]"};
    for (const calibration::DepthError& error : stereo.depth_errors) {
        table.rows.push_back({fmt::format("{:g}", error.distance_m),
                              std::isnan(error.sigma_m)
                                  ? "outside the view"
                                  : fmt::format("{:.2f}", kMillimetres * error.sigma_m)});
    }
    table.hint =
        "Depth error straight ahead of the rectified left camera, from the covariance of this "
        "calibration only. This error is the same in every image. The noise of the matching adds "
        "to the error.";
    return table;
}

eval::ReportTable lens_table(const CalibratedCamera& this_camera, calibration::LensKind kind) {
    eval::ReportTable table;
    table.title = fmt::format("Lens, {} ({})",
                              this_camera.name,
                              calibration::kLensKindNames[static_cast<std::size_t>(kind)]);
    table.header = {"parameter", "value", "one sigma"};
    const auto names = calibration::parameter_names(kind);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        table.rows.push_back({names[i],
                              fmt::format("{:.6g}", this_camera.parameters[k]),
                              fmt::format("{:.2g}", this_camera.sigmas[k])});
    }
    table.hint = fmt::format(
        "These parameters predict the image position of a direction with a median error of {:.3f} "
        "px (one sigma). The largest error in the image is {:.2f} px (one sigma). To reduce it, "
        "add views with the board near the image corners.{}",
        this_camera.mapping.median_px,
        this_camera.mapping.largest_px,
        kind == calibration::LensKind::rational
            ? " The coefficients of this lens model can compensate each other, so their single "
              "sigmas say little."
            : "");
    return table;
}

eval::ReportTable rejected_table(const CalibrationRun& run) {
    eval::ReportTable table;
    table.title = run.stereo ? "Pairs left out" : "Views left out";
    table.header = {"view", "why"};
    table.wide = true;
    for (const calibration::RejectedView& rejected : rejected_views(run))
        table.rows.push_back({run.views[rejected.index].name, why_left_out(run, rejected)});
    return table;
}

eval::ReportTable view_table(const CalibrationRun& run) {
    eval::ReportTable table;
    table.title = "Views used";
    table.header = {"view"};
    const auto cameras = calibrated_cameras(run);
    for (const CalibratedCamera& this_camera : cameras) {
        for (const char* what : {"points", "rms [px]", "tilt [deg]", "point spacing [px]"})
            table.header.push_back(fmt::format("{}: {}", this_camera.name, what));
    }
    for (std::size_t i = 0; i < cameras.front().views.size(); ++i) {
        const std::size_t index = cameras.front().views[i].index;
        std::vector<std::string> row = {run.views[index].name};
        for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
            const calibration::CameraFit& fit = cameras[camera].views[i].fit;
            const calibration::ViewShape& shape = run.coverage[camera].views[index];
            row.push_back(std::to_string(fit.ids.size() - fit.outliers.size()));
            row.push_back(fmt::format("{:.3f}", fit.rms_px));
            row.push_back(fmt::format("{:.0f}", shape.tilt_deg));
            row.push_back(fmt::format("{:.0f}", shape.spacing_px));
        }
        table.rows.push_back(std::move(row));
    }
    table.wide = true;
    table.folded = true;
    return table;
}

}  // namespace

std::string calibration_html(const CalibrationRun& run) {
    eval::ReportContent content;
    content.title = run.stereo ? "Calibration of a stereo camera" : "Calibration of a camera";
    content.summary = {fmt::format("{}: {} views of {}, images of {} x {} px.",
                                   run.source,
                                   run.views.size(),
                                   run.board_text,
                                   run.size.width,
                                   run.size.height)};
    add_pictures(run, content);
    add_figures(run, content);
    for (int camera = 0; camera < run.cameras(); ++camera) {
        for (const std::string& advice : run.coverage[static_cast<std::size_t>(camera)].advice)
            content.reasons.push_back(camera_name(run, camera) + ": " + advice);
    }
    for (const std::string& note : run.notes) content.reasons.push_back(note);
    content.details_title = "Cameras and views";
    if (run.stereo) content.tables.push_back(depth_table(*run.stereo));
    for (const CalibratedCamera& this_camera : calibrated_cameras(run))
        content.tables.push_back(lens_table(this_camera, lens_kind(run)));
    content.tables.push_back(rejected_table(run));
    content.tables.push_back(view_table(run));
    return eval::render_html(content);
}

}  // namespace surefoot::app
