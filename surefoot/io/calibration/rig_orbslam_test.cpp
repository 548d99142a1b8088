// SPDX-License-Identifier: Apache-2.0
// Settings files of ORB-SLAM as users have them.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

Result<RigFile> orbslam(const std::string& text) {
    return parse_rig_file(text, "EuRoC.yaml");
}

TEST(RigVariants, OrbSlam3SettingsAreRead) {
    const auto file = orbslam(kOrbSlam3);
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(file->format, RigFormat::orbslam);
    EXPECT_NEAR(baseline_m(file), 0.110078, kPrinted_m);
    EXPECT_GT(file->rig.T_left_right.translation_m.x(), 0.11);
    EXPECT_EQ(pinhole(*file->rig.right).cy_px, 255.238);
    EXPECT_EQ(pinhole(file->rig.left).p2, 1.76187114e-05);
    EXPECT_EQ(file->rig.rate_hz, 20.0);
    EXPECT_FALSE(file->rig.imu);

    const auto inertial =
        orbslam(kOrbSlam3 +
                "IMU.Frequency: 200.0\nIMU.T_b_c1: !!opencv-matrix\n  rows: 4\n  cols: 4\n"
                "  data: [0, -1, 0, -0.02, 1, 0, 0, -0.06, 0, 0, 1, 0.01, 0, 0, 0, 1]\n");
    ASSERT_TRUE(inertial.ok()) << message(inertial);
    ASSERT_TRUE(inertial->rig.imu);
    // The camera's centre in the IMU frame, back from both poses.
    const Pose T_imu_left = inertial->rig.imu->T_body_imu.inverse() * *inertial->rig.T_body_left;
    EXPECT_LT((T_imu_left.translation_m - Eigen::Vector3d(-0.02, -0.06, 0.01)).norm(), kExact);

    EXPECT_TRUE(
        contains(message(orbslam(kOrbSlam3.substr(0, kOrbSlam3.find("Stereo.T_c1_c2")))),
                 "EuRoC.yaml:3: Stereo.T_c1_c2: this key is missing, but two cameras need"));
    EXPECT_TRUE(contains(message(orbslam(replaced(kOrbSlam3, "Camera2.cx", "Camera2.c"))),
                         "key 'Camera2.cx' is missing"));
    EXPECT_TRUE(contains(message(orbslam(replaced(kOrbSlam3, "0.110074137800478", "110.07"))),
                         "exceeds 5 m: is it in mm"));
    const auto mono = orbslam(
        "Camera.type: \"PinHole\"\nCamera1.fx: 458\nCamera.width: 752\nCamera.height: 480\n");
    EXPECT_TRUE(contains(message(mono), "these ORB-SLAM settings are for one camera"));
}

TEST(RigVariants, OrbSlam2SettingsAreRead) {
    const auto rectified = orbslam(kOrbSlam2);
    ASSERT_TRUE(rectified.ok()) << message(rectified);
    EXPECT_TRUE(rectified->rig.rectified);
    EXPECT_NEAR(baseline_m(rectified), 47.906 / 435.2, kExact);
    EXPECT_TRUE(has_note(rectified, "assumes rectified images"));
    EXPECT_TRUE(contains(message(orbslam(replaced(kOrbSlam2, "Camera.k1: 0.0", "Camera.k1: -0.2"))),
                         "this key is for rectified images"));

    const auto raw =
        orbslam(kOrbSlam2 + orbslam2_side("LEFT", "0.0") + orbslam2_side("RIGHT", "-47.906"));
    ASSERT_TRUE(raw.ok()) << message(raw);
    EXPECT_FALSE(raw->rig.rectified);
    EXPECT_EQ(pinhole(raw->rig.left).k1, -0.28);
    EXPECT_NEAR(baseline_m(raw), 47.906 / 435.2, kExact);
    EXPECT_NEAR(raw->rig.T_left_right.translation_m.x(), 0.8 * 47.906 / 435.2, kExact);

    EXPECT_TRUE(contains(message(orbslam(kOrbSlam2 + orbslam2_side("LEFT", "0.0"))),
                         "RIGHT.K: this key is missing: these ORB-SLAM settings describe the raw "
                         "images of one camera only"));
    const auto rgbd = orbslam(kOrbSlam2 + "DepthMapFactor: 5000.0\n");
    ASSERT_TRUE(rgbd.ok()) << message(rgbd);
    EXPECT_FALSE(rgbd->rig.right);
    EXPECT_TRUE(rgbd->rig.rectified);
}

}  // namespace
}  // namespace surefoot::io::testing
