// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/calibration_run.hpp"

#include <algorithm>
#include <variant>

#include "surefoot/core/assert.hpp"

namespace surefoot::app {
namespace {

/// Sets the uncertainty of each parameter and of the whole mapping from the covariance.
void add_uncertainty(const Eigen::MatrixXd& covariance,
                     calibration::LensKind kind,
                     CalibratedCamera& this_camera) {
    this_camera.sigmas = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    this_camera.mapping =
        calibration::mapping_sigmas_px(kind,
                                       this_camera.parameters,
                                       covariance,
                                       {this_camera.camera.width, this_camera.camera.height});
}

/// Returns the parameters in the order of calibration::parameter_names.
Eigen::VectorXd parameters_of(const camera::PinholeRadTan& k, calibration::LensKind kind) {
    Eigen::VectorXd all(9);
    all << k.fx_px, k.fy_px, k.cx_px, k.cy_px, k.k1, k.k2, k.p1, k.p2, k.k3;
    return kind == calibration::LensKind::pinhole4 ? Eigen::VectorXd(all.head(8)) : all;
}
Eigen::VectorXd parameters_of(const camera::PinholeRational& k, calibration::LensKind) {
    Eigen::VectorXd all(12);
    all << k.fx_px, k.fy_px, k.cx_px, k.cy_px, k.k1, k.k2, k.p1, k.p2, k.k3, k.k4, k.k5, k.k6;
    return all;
}
Eigen::VectorXd parameters_of(const camera::KannalaBrandt& k, calibration::LensKind) {
    Eigen::VectorXd all(8);
    all << k.fx_px, k.fy_px, k.cx_px, k.cy_px, k.k1, k.k2, k.k3, k.k4;
    return all;
}

CalibratedCamera stereo_camera(const calibration::StereoCalibration& stereo, bool left) {
    const auto count = static_cast<Eigen::Index>(calibration::parameter_names(stereo.kind).size());
    CalibratedCamera this_camera;
    this_camera.name = left ? "left" : "right";
    this_camera.camera = left ? stereo.rig.left : *stereo.rig.right;
    this_camera.parameters =
        std::visit([&](const auto& lens) { return parameters_of(lens, stereo.kind); },
                   this_camera.camera.model);
    const Eigen::Index first = left ? 0 : count;
    add_uncertainty(stereo.covariance.block(first, first, count, count), stereo.kind, this_camera);
    for (const calibration::PairFit& pair : stereo.pairs)
        this_camera.views.push_back({pair.index, left ? pair.left : pair.right});
    return this_camera;
}

}  // namespace

std::vector<CalibratedCamera> calibrated_cameras(const CalibrationRun& run) {
    if (run.stereo) return {stereo_camera(*run.stereo, true), stereo_camera(*run.stereo, false)};
    SUREFOOT_ASSERT(run.mono.has_value());
    CalibratedCamera this_camera;
    this_camera.name = "camera";
    this_camera.camera = run.mono->camera;
    this_camera.parameters = run.mono->parameters;
    add_uncertainty(run.mono->covariance, run.mono->kind, this_camera);
    for (const calibration::ViewFit& view : run.mono->views)
        this_camera.views.push_back({view.index, view.camera});
    return {this_camera};
}

const std::vector<calibration::RejectedView>& rejected_views(const CalibrationRun& run) {
    return run.stereo ? run.stereo->rejected : run.mono->rejected;
}

calibration::LensKind lens_kind(const CalibrationRun& run) {
    return run.stereo ? run.stereo->kind : run.mono->kind;
}

std::string camera_name(const CalibrationRun& run, int camera) {
    return run.cameras() == 1 ? "camera" : camera == 0 ? "left" : "right";
}

std::string why_left_out(const CalibrationRun& run, const calibration::RejectedView& rejected) {
    const FoundView& view = run.views[rejected.index];
    if (view.left_problem.empty() && view.right_problem.empty()) return rejected.reason;
    if (run.cameras() == 1) return view.left_problem;
    std::string why;
    if (!view.left_problem.empty()) why += "left: " + view.left_problem;
    if (!view.right_problem.empty())
        why += (why.empty() ? "right: " : "; right: ") + view.right_problem;
    return why;
}

Eigen::Vector2d pixel_of(const calibration::BoardView& view, int id) {
    const auto at = std::lower_bound(view.ids.begin(), view.ids.end(), id);
    SUREFOOT_ASSERT(at != view.ids.end() && *at == id);
    return view.pixels[static_cast<std::size_t>(at - view.ids.begin())];
}

camera::StereoRig calibrated_rig(const CalibrationRun& run) {
    if (run.stereo) return run.stereo->rig;
    camera::StereoRig rig;
    rig.left = run.mono->camera;
    return rig;
}

}  // namespace surefoot::app
