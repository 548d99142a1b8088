// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::odometry {

/// Measurement of a point by an ideal stereo camera in rectified pixels: (u_left, v, u_right). The
/// errors of the three values are independent, because each camera is aligned separately. If
/// u_right is NaN (unknown), only (u_left, v) counts. The disparity is u_left - u_right.
using StereoPixel = Eigen::Vector3d;

[[nodiscard]] inline double disparity_px(const StereoPixel& pixel) noexcept {
    return pixel.x() - pixel.z();
}

/// Projects a point of the rectified left optical frame (z > 0) into both rectified images.
[[nodiscard]] inline StereoPixel project_stereo(const camera::RectifiedRig& rig,
                                                const Eigen::Vector3d& p_camera,
                                                Eigen::Matrix3d* d_pixel_d_point = nullptr) {
    const double inverse_z = 1.0 / p_camera.z();
    const double x = p_camera.x() * inverse_z;
    const double y = p_camera.y() * inverse_z;
    const double x_right = (p_camera.x() - rig.baseline_m) * inverse_z;
    if (d_pixel_d_point != nullptr) {
        *d_pixel_d_point << rig.fx_px * inverse_z, 0.0, -rig.fx_px * x * inverse_z,  //
            0.0, rig.fy_px * inverse_z, -rig.fy_px * y * inverse_z,                  //
            rig.fx_px * inverse_z, 0.0, -rig.fx_px * x_right * inverse_z;
    }
    return {rig.fx_px * x + rig.cx_px, rig.fy_px * y + rig.cy_px, rig.fx_px * x_right + rig.cx_px};
}

/// Point in the rectified left optical frame, from a measurement with disparity > 0.
[[nodiscard]] inline Eigen::Vector3d triangulate(const camera::RectifiedRig& rig,
                                                 const StereoPixel& pixel) {
    return rig.point(pixel.x(), pixel.y(), disparity_px(pixel));
}

/// Covariance [m^2] of the triangulated point to first order; `sigma_px` applies to each component.
[[nodiscard]] inline Eigen::Matrix3d point_covariance(const camera::RectifiedRig& rig,
                                                      const StereoPixel& pixel,
                                                      double sigma_px) {
    const double d_px = disparity_px(pixel);
    const double z_m = rig.depth_to_disparity_px_m() / d_px;
    const Eigen::Vector3d ray(
        (pixel.x() - rig.cx_px) / rig.fx_px, (pixel.y() - rig.cy_px) / rig.fy_px, 1.0);
    // point = z ray with z = f b / (u_left - u_right): columns are its derivatives by u_left, v,
    // u_right.
    Eigen::Matrix3d J;
    J.col(0) = -z_m / d_px * ray + Eigen::Vector3d(z_m / rig.fx_px, 0.0, 0.0);
    J.col(1) = Eigen::Vector3d(0.0, z_m / rig.fy_px, 0.0);
    J.col(2) = z_m / d_px * ray;
    return sigma_px * sigma_px * J * J.transpose();
}

/// Image motion of a point during `dt_s`, to first order, while the camera moves with `velocity`
/// per second (translation, rotation; in camera axes, as a right perturbation).
[[nodiscard]] inline StereoPixel pixel_motion(const camera::RectifiedRig& rig,
                                              const Eigen::Vector3d& p_camera,
                                              const Vector6& velocity,
                                              double dt_s) {
    Eigen::Matrix3d d_pixel_d_point;
    static_cast<void>(project_stereo(rig, p_camera, &d_pixel_d_point));
    const Eigen::Vector3d p_camera_m_s = -velocity.head<3>() - velocity.tail<3>().cross(p_camera);
    return dt_s * d_pixel_d_point * p_camera_m_s;
}

}  // namespace surefoot::odometry
