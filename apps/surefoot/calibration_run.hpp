// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot/board_images.hpp"
#include "surefoot/calibration/bundle/coverage.hpp"
#include "surefoot/calibration/lenses/lens_mapping.hpp"
#include "surefoot/calibration/stereo_calibration.hpp"

namespace surefoot::app {

/// What was found of the board in the images of one moment.
struct FoundView {
    std::string name;
    calibration::BoardView left;  ///< or the only camera's; empty with its problem
    calibration::BoardView right;
    std::string left_problem;
    std::string right_problem;
};

/// Everything that `calibrate` shows and writes. Exactly one of `mono` and `stereo` is set.
struct CalibrationRun {
    std::string source;
    std::string board_text;
    calibration::Board board;
    calibration::ImageSize size;
    std::vector<FoundView> views;
    std::vector<std::string> notes;
    std::vector<calibration::Coverage> coverage;  ///< one per camera
    BoardImages sample;                           ///< the first in which every camera saw the board
    std::optional<calibration::MonoCalibration> mono;
    std::optional<calibration::StereoCalibration> stereo;

    [[nodiscard]] int cameras() const { return static_cast<int>(coverage.size()); }
};

/// One camera of a run's result, whichever kind it is.
struct CalibratedEye {
    const char* name = "";
    camera::Camera camera;
    Eigen::VectorXd parameters;          ///< order of parameter_names
    Eigen::VectorXd sigmas;              ///< one standard deviation each
    calibration::MappingSigmas mapping;  ///< what they mean together
    struct View {
        std::size_t index = 0;  ///< into CalibrationRun::views
        calibration::EyeFit fit;
    };
    std::vector<View> views;
};
[[nodiscard]] std::vector<CalibratedEye> calibrated_eyes(const CalibrationRun& run);
[[nodiscard]] const std::vector<calibration::RejectedView>& rejected_views(
    const CalibrationRun& run);
[[nodiscard]] calibration::LensKind lens_kind(const CalibrationRun& run);
[[nodiscard]] std::string camera_name(const CalibrationRun& run, int camera);
/// Why a view does not count: what the detection said, else what the calibration says.
[[nodiscard]] std::string why_left_out(const CalibrationRun& run,
                                       const calibration::RejectedView& rejected);
/// Pixel of a point of a found view; the view must show it.
[[nodiscard]] Eigen::Vector2d pixel_of(const calibration::BoardView& view, int id);
/// The rig to write; of one camera, a rig without a right one.
[[nodiscard]] camera::StereoRig calibrated_rig(const CalibrationRun& run);

}  // namespace surefoot::app
