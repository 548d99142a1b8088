// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"

/// Rigs for tests.
namespace surefoot::camera::test {

/// EuRoC MAV, VI-Sensor of the Vicon room sequences: published calibration of cam0 and cam1.
inline StereoRig euroc_rig() {
    Eigen::Matrix4d T_body_cam0;
    T_body_cam0 << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,
        0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768, -0.0257744366974,
        0.00375618835797, 0.999660727178, 0.00981073058949, 0.0, 0.0, 0.0, 1.0;
    Eigen::Matrix4d T_body_cam1;
    T_body_cam1 << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,
        0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024, -0.0253898008918,
        0.0179005838253, 0.999517347078, 0.00786212447038, 0.0, 0.0, 0.0, 1.0;
    StereoRig rig;
    rig.name = "euroc";
    rig.left = {PinholeRadTan{.fx_px = 458.654,
                              .fy_px = 457.296,
                              .cx_px = 367.215,
                              .cy_px = 248.375,
                              .k1 = -0.28340811,
                              .k2 = 0.07395907,
                              .p1 = 0.00019359,
                              .p2 = 1.76187114e-05},
                752,
                480};
    rig.right = Camera{PinholeRadTan{.fx_px = 457.587,
                                     .fy_px = 456.134,
                                     .cx_px = 379.999,
                                     .cy_px = 255.238,
                                     .k1 = -0.28368365,
                                     .k2 = 0.07451284,
                                     .p1 = -0.00010473,
                                     .p2 = -3.55590700e-05},
                       752,
                       480};
    rig.T_body_left = Pose::from_matrix(T_body_cam0);
    rig.T_left_right = rig.T_body_left->inverse() * Pose::from_matrix(T_body_cam1);
    rig.rate_hz = 20.0;
    return rig;
}

/// A pair of 170 deg fisheye lenses with axes 1.5 deg apart, as in home-made rigs.
inline StereoRig fisheye_rig() {
    StereoRig rig;
    rig.name = "fisheye";
    rig.left = {KannalaBrandt{.fx_px = 227.0,
                              .fy_px = 227.0,
                              .cx_px = 472.2,
                              .cy_px = 306.9,
                              .k1 = 0.0121,
                              .k2 = 0.0056,
                              .k3 = -0.0061,
                              .k4 = 0.0005},
                960,
                600};
    rig.right = rig.left;
    rig.right->model = KannalaBrandt{.fx_px = 226.2,
                                     .fy_px = 226.2,
                                     .cx_px = 477.9,
                                     .cy_px = 296.2,
                                     .k1 = 0.0121,
                                     .k2 = 0.0056,
                                     .k3 = -0.0061,
                                     .k4 = 0.0005};
    rig.T_left_right = {exp_so3({0.015, -0.02, 0.01}), {0.1097, 0.0012, -0.0021}};
    return rig;
}

/// First-generation ZED at 672x376: ideal, rectified images.
inline StereoRig zed_rig() {
    StereoRig rig;
    rig.name = "zed";
    rig.left = {
        PinholeRadTan{.fx_px = 342.0, .fy_px = 342.0, .cx_px = 336.0, .cy_px = 188.0}, 672, 376};
    rig.right = rig.left;
    rig.T_left_right.translation_m = {0.12, 0.0, 0.0};
    rig.rectified = true;
    return rig;
}

/// Lenses without distortion that point straight ahead, 0.12 m apart.
inline StereoRig ideal_rig(int width, int height, double focal_px) {
    StereoRig rig;
    rig.left = {PinholeRadTan{.fx_px = focal_px,
                              .fy_px = focal_px,
                              .cx_px = 0.5 * (width - 1),
                              .cy_px = 0.5 * (height - 1)},
                width,
                height};
    rig.right = rig.left;
    rig.T_left_right.translation_m = {0.12, 0.0, 0.0};
    return rig;
}

}  // namespace surefoot::camera::test
