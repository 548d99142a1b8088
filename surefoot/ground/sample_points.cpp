// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/sample_points.hpp"

#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::ground {

namespace {

/// Remaining disparity error of a calibrated rig: a constant of this size. At the side and at the
/// upper or lower border of the image, another error of this size adds to it. ASSUMPTION: valid
/// after calibration with boards and self-calibration.
constexpr double kCalibrationSigma_px = 0.05;

/// d = f b m . (x, y, 1) over the image plane. A constant error of d is an error of m along the
/// optical axis. An error that grows along the image is an error across the axis.
Eigen::Matrix3d calibration_covariance(const camera::RectifiedRig& rig) {
    const double fb_px_m = rig.depth_to_disparity_px_m();
    const Eigen::Vector3d sigma =
        kCalibrationSigma_px / fb_px_m *
        Eigen::Vector3d(2.0 * rig.fx_px / rig.width, 2.0 * rig.fy_px / rig.height, 1.0);
    const Eigen::Matrix3d R = rig.T_body_camera.R();
    return R * sigma.cwiseAbs2().asDiagonal() * R.transpose();
}

}  // namespace

void sample_points(const camera::RectifiedRig& rig,
                   const DepthImage& depth,
                   int step_px,
                   FramePoints& seen,
                   float max_outlier_probability) {
    SUREFOOT_ASSERT(step_px > 0);
    seen.camera_body_m = rig.T_body_camera.translation_m;
    seen.points_body_m.clear();
    seen.inverse_range_sigma.clear();
    seen.pixels = 0;
    seen.calibration_covariance = calibration_covariance(rig);
    const Eigen::Matrix3d R_body_camera = rig.T_body_camera.R();
    for (int v = step_px / 2; v < depth.disparity_px.height(); v += step_px) {
        const float* disparity = depth.disparity_px.row(v);
        const float* sigma = depth.sigma_px.row(v);
        const float* outlier = depth.outlier_probability.row(v);
        for (int u = step_px / 2; u < depth.disparity_px.width(); u += step_px) {
            ++seen.pixels;
            const auto d_px = static_cast<double>(disparity[u]);
            const auto sigma_px = static_cast<double>(sigma[u]);
            if (!(d_px > 0.0 && std::isfinite(d_px))) continue;
            if (!(sigma_px > 0.0 && std::isfinite(sigma_px))) continue;
            if (!(outlier[u] <= max_outlier_probability)) continue;
            const Eigen::Vector3d p_camera_m = rig.point(u, v, d_px);
            seen.points_body_m.emplace_back(R_body_camera * p_camera_m + seen.camera_body_m);
            // 1 / range is proportional to the disparity along a ray.
            seen.inverse_range_sigma.push_back(sigma_px / (d_px * p_camera_m.norm()));
        }
    }
}

}  // namespace surefoot::ground
