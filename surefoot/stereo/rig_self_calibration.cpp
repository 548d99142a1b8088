// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/rig_self_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::stereo {
namespace {

constexpr int kRounds = 8;      ///< number of re-weightings; four or five are enough
constexpr double kHuber = 1.5;  ///< limit of full weight [sigmas]
/// Corners within a few degrees of each other share lens errors. This many corners count as one.
constexpr double kCornersPerIndependent = 4.0;
/// Sigmas of a weak prior. Without a prior, a few corners on a line could give any result.
constexpr double kPriorTurn_rad = 0.01;
constexpr double kPriorFocal = 0.01;
constexpr double kLeastSigma_px = 0.02;

double median_abs(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return upper_median_in_place(values);
}

struct Row {
    Eigen::Vector3d a;  ///< d row / d (roll, pitch, focal share) [px]
    double rows_px;
};

std::vector<Row> rows_of(const camera::RectifiedRig& rig, std::span<const CornerShift> corners) {
    std::vector<Row> rows;
    rows.reserve(corners.size());
    for (const CornerShift& corner : corners) {
        const double x = (corner.u_px + corner.columns_px - rig.cx_px) / rig.fx_px;
        const double y = (corner.v_px - rig.cy_px) / rig.fy_px;
        rows.push_back({rig.fy_px * Eigen::Vector3d(-x, 1.0 + y * y, y), corner.rows_px});
    }
    return rows;
}

std::vector<double> residuals_px(std::span<const Row> rows, const Eigen::Vector3d& parameters) {
    std::vector<double> residuals;
    residuals.reserve(rows.size());
    for (const Row& row : rows) residuals.push_back(row.rows_px - row.a.dot(parameters));
    return residuals;
}

}  // namespace

void SelfCalibrationConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean(
        "enabled",
        enabled,
        "true: correct the right camera's calibration by the row errors of the first frames");
    visitor.integer("min_corners",
                    min_corners,
                    20,
                    100000,
                    "smallest number of matched corners that a correction needs");
    visitor.number("max_turn_deg",
                   max_turn_deg,
                   0.0,
                   5.0,
                   "largest rotation that is corrected. A larger rotation is not corrected: "
                   "calibrate the rig again");
    visitor.number("max_focal_share",
                   max_focal_share,
                   0.0,
                   0.1,
                   "largest relative change of the focal length that is corrected. A larger change "
                   "is not corrected: calibrate the rig again");
}

std::optional<RigSelfCalibration> estimate_self_calibration(const SelfCalibrationConfig& config,
                                                            const camera::RectifiedRig& rig,
                                                            std::span<const CornerShift> corners) {
    if (corners.size() < static_cast<std::size_t>(std::max(config.min_corners, 1))) {
        return std::nullopt;
    }
    const std::vector<Row> rows = rows_of(rig, corners);
    const Eigen::Vector3d prior(1.0 / (kPriorTurn_rad * kPriorTurn_rad),
                                1.0 / (kPriorTurn_rad * kPriorTurn_rad),
                                1.0 / (kPriorFocal * kPriorFocal));
    Eigen::Vector3d parameters = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information = prior.asDiagonal();
    for (int round = 0; round < kRounds; ++round) {
        const std::vector<double> left_px = residuals_px(rows, parameters);
        const double sigma_px = std::max(1.4826 * median_abs(left_px), kLeastSigma_px);
        information = prior.asDiagonal();
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const double sigmas = std::abs(left_px[i]) / sigma_px;
            const double huber = sigmas <= kHuber ? 1.0 : kHuber / sigmas;
            const double weight = huber / (kCornersPerIndependent * sigma_px * sigma_px);
            information += weight * rows[i].a * rows[i].a.transpose();
            gradient += weight * rows[i].rows_px * rows[i].a;
        }
        parameters = information.ldlt().solve(gradient);
    }
    if (!parameters.allFinite() || parameters.head<2>().norm() > config.max_turn_deg * kRadPerDeg ||
        std::abs(parameters[2]) > config.max_focal_share) {
        return std::nullopt;
    }
    RigSelfCalibration self_calibration;
    self_calibration.camera = {parameters[0], parameters[1], 0.0, parameters[2]};
    self_calibration.sigma = information.inverse().diagonal().cwiseSqrt();
    self_calibration.corners = static_cast<int>(corners.size());
    self_calibration.row_error_px = median_abs(residuals_px(rows, Eigen::Vector3d::Zero()));
    self_calibration.row_error_left_px = median_abs(residuals_px(rows, parameters));
    self_calibration.significance = parameters.dot(information * parameters);
    return self_calibration;
}

}  // namespace surefoot::stereo
