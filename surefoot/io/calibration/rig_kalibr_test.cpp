// SPDX-License-Identifier: Apache-2.0
// Calibration files of Kalibr as users have them.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

const std::string kCamera =
    "  camera_model: pinhole\n  distortion_coeffs: [-0.39, 0.15, -0.001, 0.0002]\n"
    "  distortion_model: radtan\n  intrinsics: [1073.7, 1073.8, 639.9, 350.3]\n"
    "  resolution: [1280, 800]\n";
const std::string kIdentity =
    "  - [1, 0, 0, 0]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";
const std::string kMoved =
    "  - [0.9999989, -0.00011383, 0.00147396, -0.119879]\n"
    "  - [0.00010639, 0.9999873, 0.005045, 5.2472e-05]\n"
    "  - [-0.0014745, -0.0050448, 0.99998619, -0.00011958]\n  - [0, 0, 0, 1]\n";

TEST(RigVariants, KalibrFindsThePoseThroughTheImu) {
    const auto file = parse_rig_file(
        "cam0:\n  T_cam_imu:\n" + kIdentity + kCamera + "cam1:\n  T_cam_imu:\n" + kMoved + kCamera,
        "c.yaml");
    ASSERT_TRUE(file.ok()) << message(file);
    const auto direct =
        parse_rig_file("cam0:\n" + kCamera + "cam1:\n  T_cn_cnm1:\n" + kMoved + kCamera, "c.yaml");
    ASSERT_TRUE(direct.ok()) << message(direct);
    EXPECT_NEAR(baseline_m(file), 0.119879, kPrinted_m);
    EXPECT_LT(difference(file->rig.T_left_right, direct->rig.T_left_right).norm(), kExact);
    EXPECT_TRUE(has_note(file, "cam1 has no T_cn_cnm1"));
    EXPECT_TRUE(file->rig.imu);

    const auto neither = parse_rig_file("cam0:\n" + kCamera + "cam1:\n" + kCamera, "c.yaml");
    EXPECT_TRUE(contains(message(neither), "Run kalibr_calibrate_cameras with both topics"));
    // OpenVINS writes the inverse: the camera in the IMU frame. The IMU lies 0.05 m below cam0, so
    // that cam0 is at y = -0.05 in it, and cam1 0.12 m to the right of that.
    const std::string in_imu0 =
        "  - [1, 0, 0, 0]\n  - [0, 1, 0, -0.05]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";
    const std::string in_imu1 =
        "  - [1, 0, 0, 0.12]\n  - [0, 1, 0, -0.05]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";
    const auto openvins = parse_rig_file("%YAML:1.0\ncam0:\n  T_imu_cam:\n" + in_imu0 + kCamera +
                                             "cam1:\n  T_imu_cam:\n" + in_imu1 + kCamera,
                                         "kalibr_imucam_chain.yaml");
    ASSERT_TRUE(openvins.ok()) << message(openvins);
    EXPECT_LT((openvins->rig.T_left_right.translation_m - Eigen::Vector3d(0.12, 0.0, 0.0)).norm(),
              kExact);
    for (const char* model : {"ds", "eucm", "omni"}) {
        const std::string camera =
            replaced(kCamera, "camera_model: pinhole", std::string("camera_model: ") + model);
        EXPECT_TRUE(
            contains(message(parse_rig_file("cam0:\n" + camera + "cam1:\n" + camera, "c.yaml")),
                     "is not supported; calibrate with pinhole-radtan"));
    }
}

}  // namespace
}  // namespace surefoot::io::testing
