// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/stereo_rig.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::camera {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename Change>
std::string problem_after(StereoRig rig, Change change) {
    change(rig);
    return rig.problem().value_or("no problem");
}

PinholeRadTan& pinhole(Camera& camera) {
    return std::get<PinholeRadTan>(camera.model);
}

TEST(StereoRig, GoodRigsHaveNoProblem) {
    EXPECT_EQ(test::euroc_rig().problem(), std::nullopt);
    EXPECT_EQ(test::fisheye_rig().problem(), std::nullopt);
    EXPECT_EQ(test::zed_rig().problem(), std::nullopt);
    StereoRig rgbd = test::zed_rig();
    rgbd.right.reset();
    EXPECT_EQ(rgbd.problem(), std::nullopt);
}

TEST(StereoRig, NamesTheCameraThatIsWrong) {
    EXPECT_EQ(problem_after(test::euroc_rig(), [](StereoRig& r) { pinhole(r.left).k1 = kNan; }),
              "left camera: pinhole k1 = nan is not a finite number");
    EXPECT_EQ(
        problem_after(test::euroc_rig(), [](StereoRig& r) { pinhole(*r.right).fx_px = -1.0; }),
        "right camera: pinhole fx_px = -1 must be > 0 px");
    EXPECT_EQ(
        problem_after(test::euroc_rig(), [](StereoRig& r) { r.right->height = 481; }),
        "image sizes differ: left 752x480, right 752x481 px; both cameras need the same size");
}

TEST(StereoRig, RefusesImpossibleGeometry) {
    EXPECT_EQ(problem_after(test::euroc_rig(),
                            [](StereoRig& r) { r.T_left_right.translation_m.setZero(); }),
              "baseline 0.000 mm is below 1 mm. Give the distance of the cameras in metres");
    EXPECT_EQ(
        problem_after(test::euroc_rig(), [](StereoRig& r) { r.T_left_right.translation_m *= 1e3; }),
        "baseline 110.078 m exceeds 5 m: is it in mm (then 110.1 mm)? Give it in metres");
    EXPECT_EQ(problem_after(test::euroc_rig(),
                            [](StereoRig& r) { r.T_left_right.translation_m.y() = kNan; }),
              "T_left_right holds a value that is not finite: correct the calibration");
    EXPECT_EQ(problem_after(test::euroc_rig(),
                            [](StereoRig& r) { r.T_left_right.rotation.coeffs() *= 1.1; }),
              "T_left_right is not rigid: its rotation quaternion has norm 1.100000, not 1; "
              "correct the calibration");
    EXPECT_EQ(
        problem_after(test::zed_rig(), [](StereoRig& r) { r.T_left_right.translation_m *= -1.0; }),
        "the right camera lies 0.120 m to the left of the left one; swap the cameras or "
        "invert T_left_right");
    EXPECT_EQ(problem_after(test::zed_rig(),
                            [](StereoRig& r) {
                                r.T_left_right.translation_m = {0.0, 0.1, 0.0};
                            }),
              "baseline (0.000, 0.100, 0.000) m must point along x of the left camera; vertical "
              "stereo is not supported");
    EXPECT_EQ(
        problem_after(test::euroc_rig(),
                      [](StereoRig& r) {
                          r.T_left_right.rotation = exp_so3({0.0, 1.0, 0.0});
                      }),
        "the cameras are turned 57.3 deg against each other; at most 45 deg can be rectified");
}

TEST(StereoRig, ChecksTheClaimOfBeingRectified) {
    EXPECT_EQ(problem_after(test::zed_rig(), [](StereoRig& r) { pinhole(*r.right).k1 = 0.1; }),
              "the rig is marked rectified but its right camera has distortion (k1 = 0.1, k2 = 0, "
              "p1 = 0, p2 = 0, k3 = 0); give the calibration of the rectified images, or do not "
              "mark the rig rectified");
    EXPECT_EQ(problem_after(test::zed_rig(), [](StereoRig& r) { pinhole(*r.right).cx_px = 340.0; }),
              "the rig is marked rectified but cx_px differs: 336 left, 340 right; give the "
              "calibration of the rectified images, or do not mark the rig rectified");
    EXPECT_EQ(
        problem_after(test::zed_rig(),
                      [](StereoRig& r) {
                          r.T_left_right.rotation = exp_so3({0.0, 0.001, 0.0});
                      }),
        "the rig is marked rectified but its cameras are turned 0.05730 deg against each other; "
        "give the calibration of the rectified images, or do not mark the rig rectified");
    EXPECT_EQ(problem_after(test::zed_rig(),
                            [](StereoRig& r) { r.T_left_right.translation_m.y() = 0.01; }),
              "the rig is marked rectified but its baseline (0.12, 0.01, 0) m is not along x; give "
              "the calibration of the rectified images, or do not mark the rig rectified");
    EXPECT_EQ(problem_after(test::fisheye_rig(), [](StereoRig& r) { r.rectified = true; }),
              "the rig is marked rectified but its left camera has a fisheye model; give the "
              "calibration of the rectified images, or do not mark the rig rectified");
}

TEST(StereoRig, ChecksMountsAndTimes) {
    EXPECT_EQ(problem_after(test::euroc_rig(),
                            [](StereoRig& r) { r.T_body_left->translation_m.x() = kNan; }),
              "T_body_left holds a value that is not finite: correct the calibration");
    EXPECT_EQ(problem_after(test::euroc_rig(), [](StereoRig& r) { r.imu.emplace().rate_hz = 0.0; }),
              "imu.rate_hz = 0 must be between 1 and 100000 Hz");
    EXPECT_EQ(problem_after(test::euroc_rig(), [](StereoRig& r) { r.rate_hz = kNan; }),
              "rate_hz = nan must be between 0 and 10000 Hz");
    EXPECT_EQ(problem_after(test::euroc_rig(), [](StereoRig& r) { r.readout_s = -0.01; }),
              "readout_s = -0.01 must be between 0 and 1 s");
}

TEST(StereoRig, BodyIsTheOpticalFrameTurnedUnlessTheRigKnowsBetter) {
    const Pose T_body_camera = test::zed_rig().body_from_left();
    // Optical z (forward) is body x, optical x (right) is body -y, optical y (down) is body -z.
    EXPECT_LT((T_body_camera * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
    EXPECT_LT((T_body_camera * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-15);
    EXPECT_LT((T_body_camera * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15);
    const StereoRig euroc = test::euroc_rig();
    EXPECT_EQ(euroc.body_from_left().matrix(), euroc.T_body_left->matrix());
}

TEST(RectifiedRig, PointIsTheInverseOfDisparity) {
    RectifiedRig rig;
    rig.fx_px = rig.fy_px = 342.0;
    rig.cx_px = 336.0;
    rig.cy_px = 188.0;
    rig.baseline_m = 0.12;
    const Eigen::Vector3d p = rig.point(336 + 34.2, 188 - 68.4, 342 * 0.12 / 2.0);
    EXPECT_LT((p - Eigen::Vector3d(0.2, -0.4, 2.0)).norm(), 1e-12);
}

}  // namespace
}  // namespace surefoot::camera
