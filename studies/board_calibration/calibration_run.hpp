// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/board_calibration/board_images.hpp"
#include "surefoot/calibration/bundle/coverage.hpp"
#include "surefoot/calibration/lenses/lens_mapping.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"

namespace surefoot::app {

/// Board points that were detected in the images of one moment.
struct FoundView {
    std::string name;
    calibration::BoardView left;  ///< points of the left or only camera; empty after a problem
    calibration::BoardView right;
    std::string left_problem;  ///< problem of the detection; empty if it succeeded
    std::string right_problem;
};

/// All data that `calibrate` prints and writes. Once the calibration has succeeded, exactly one of
/// `mono` and `stereo` is set.
struct CalibrationRun {
    std::string source;
    std::string board_text;
    calibration::Board board;
    calibration::ImageSize size;
    std::vector<FoundView> views;
    std::vector<std::string> notes;
    std::vector<calibration::Coverage> coverage;  ///< one element per camera
    BoardImages sample;  ///< first images in which all cameras see the board
    std::optional<calibration::MonoCalibration> mono;
    std::optional<calibration::StereoCalibration> stereo;

    [[nodiscard]] int cameras() const { return static_cast<int>(coverage.size()); }
};

/// One camera of a mono or stereo calibration, in a common form.
struct CalibratedCamera {
    const char* name = "";
    camera::Camera camera;
    Eigen::VectorXd parameters;          ///< ordered as calibration::parameter_names
    Eigen::VectorXd sigmas;              ///< standard deviation of each parameter
    calibration::MappingSigmas mapping;  ///< effect of all parameter errors on the pixels
    struct View {
        std::size_t index = 0;  ///< index into CalibrationRun::views
        calibration::CameraFit fit;
    };
    std::vector<View> views;
};
/// Returns the calibrated cameras: left and right, or the only one. Requires a result in `run`.
[[nodiscard]] std::vector<CalibratedCamera> calibrated_cameras(const CalibrationRun& run);
[[nodiscard]] const std::vector<calibration::RejectedView>& rejected_views(
    const CalibrationRun& run);
[[nodiscard]] calibration::LensKind lens_kind(const CalibrationRun& run);
[[nodiscard]] std::string camera_name(const CalibrationRun& run, int camera);
/// Returns why a view was rejected: the problem of the board detection or of the calibration.
[[nodiscard]] std::string why_left_out(const CalibrationRun& run,
                                       const calibration::RejectedView& rejected);
/// Returns the pixel of the board point `id` in a view. Precondition: the view shows this point.
[[nodiscard]] Eigen::Vector2d pixel_of(const calibration::BoardView& view, int id);
/// Returns the rig to write to a file. After the calibration of one camera it has no right camera.
[[nodiscard]] camera::StereoRig calibrated_rig(const CalibrationRun& run);

}  // namespace surefoot::app
