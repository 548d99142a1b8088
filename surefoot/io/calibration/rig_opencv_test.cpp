// SPDX-License-Identifier: Apache-2.0
// Calibration files of OpenCV as users have them: names, units, sizes and lenses.
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

Result<RigFile> opencv(const std::string& text, std::optional<ImageSize> size = {}) {
    return parse_rig_file(text, "stereo.yml", size);
}

TEST(RigVariants, OpenCvMatricesAreFoundUnderTheNamesOfTutorials) {
    for (const Names& names :
         {kUsualNames,
          Names{"K1", "D1", "K2", "D2", "R", "T"},
          Names{"cameraMatrix1", "distCoeffs1", "cameraMatrix2", "distCoeffs2", "R", "T"},
          Names{"cameraMatrixL", "distCoeffsL", "cameraMatrixR", "distCoeffsR", "R", "T"},
          Names{"left_camera_matrix",
                "left_distortion",
                "right_camera_matrix",
                "right_distortion",
                "R",
                "T"},
          Names{"mtxL", "distL", "mtxR", "distR", "Rot", "Trans"},
          Names{"camera_matrix_left",
                "dist_coeffs_left",
                "camera_matrix_right",
                "dist_coeffs_right",
                "R_stereo",
                "T_stereo"},
          Names{"K_left", "D_left", "K_right", "D_right", "rotation", "translation"},
          Names{"K0", "D0", "K1", "D1", "rotation_matrix", "translation_vector"},
          Names{"leftCameraMatrix",
                "leftDistCoeffs",
                "rightCameraMatrix",
                "rightDistCoeffs",
                "R",
                "T"}}) {
        const auto file = opencv(opencv_file(names));
        ASSERT_TRUE(file.ok()) << names.K1 << ": " << message(file);
        EXPECT_EQ(file->format, RigFormat::opencv);
        EXPECT_EQ(pinhole(file->rig.left).fx_px, 700.0) << names.K1;
        EXPECT_EQ(pinhole(file->rig.right.value()).fx_px, 702.0) << names.K1;
        EXPECT_NEAR(baseline_m(file), 0.120001, kPrinted_m);
    }
    const std::string groups =
        "left:\n  K: [700, 0, 640, 0, 700, 360, 0, 0, 1]\n  D: [0, 0, 0, 0, 0]\n"
        "right:\n  K: [700, 0, 640, 0, 700, 360, 0, 0, 1]\n  D: [0, 0, 0, 0, 0]\n"
        "extrinsics:\n  R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n  T: [-0.1, 0, 0]\nimage_size: [1280, "
        "720]\n";
    const auto grouped = opencv(groups);
    ASSERT_TRUE(grouped.ok()) << message(grouped);
    EXPECT_TRUE(grouped->rig.rectified);
}

TEST(RigVariants, OpenCvSaysWhichCameraIsMissing) {
    EXPECT_EQ(message(opencv(replaced(opencv_file(kUsualNames), "M2:", "N2:"))),
              "stereo.yml:3: camera matrix of the right camera: not found; the key of the other "
              "camera is 'M1'. Use the same name for both keys, except for 1 and 2, left and "
              "right, or l and r");
    EXPECT_TRUE(
        contains(message(opencv(replaced(opencv_file(kUsualNames), "D1:", "E1:"))),
                 "distortion of the left camera: not found; the key of the other camera is 'D2'"));
    const std::string from_zero = opencv_file({"K0", "D0", "K1", "D1", "R", "T"});
    EXPECT_TRUE(
        contains(message(opencv(replaced(from_zero, "D0:", "E0:"))),
                 "distortion of the left camera: not found; the key of the other camera is 'D1'"))
        << "beside K0 and K1, D1 is the right camera's";
    EXPECT_TRUE(contains(message(opencv("camera_matrix: [700, 0, 640, 0, 700, 360, 0, 0, 1]\n"
                                        "distortion_coefficients: [0, 0, 0, 0, 0]\n")),
                         "looks like an OpenCV calibration of one camera; a rig needs"));
    EXPECT_TRUE(contains(message(opencv("<?xml version=\"1.0\"?>\n<opencv_storage>\n")),
                         "looks like an XML file of OpenCV; only YAML and JSON files of OpenCV"));
}

TEST(RigVariants, OpenCvUnitsAreNamed) {
    const auto with_T = [](const char* T) { return opencv(opencv_file(kUsualNames, T)); };
    EXPECT_TRUE(contains(message(with_T("[ -120, 0.4, 0.2 ]")),
                         "T: baseline 120.001 m exceeds 5 m: is it in mm (then 120.0 mm)?"));
    EXPECT_TRUE(contains(message(with_T("[ -12, 0.04, 0.02 ]")), "is it in cm (then 120.0 mm)"));
    const auto squares = with_T("[ -3.327, 0.01, 0.02 ]");
    EXPECT_TRUE(squares.ok()) << message(squares);
    EXPECT_TRUE(has_note(squares, "3.327 m is longer than 1 m")) << "the unit is only guessed";
    EXPECT_TRUE(has_note(squares, "in squares of a chessboard?"));
    EXPECT_TRUE(contains(message(with_T("[ 0.12, 0.0004, 0.0002 ]")), "swap the cameras"));
}

TEST(RigVariants, OpenCvSizeRotationAndLens) {
    const std::string no_size =
        replaced(opencv_file(kUsualNames), "image_width: 1280\nimage_height: 720\n", "");
    EXPECT_TRUE(contains(message(opencv(no_size)), "--resolution WIDTHxHEIGHT"));
    const auto sized = opencv(no_size, ImageSize{1280, 720});
    ASSERT_TRUE(sized.ok()) << message(sized);
    EXPECT_EQ(sized->rig.left.width, 1280);
    EXPECT_TRUE(opencv("image_size: [1280, 720]\n" + no_size.substr(no_size.find("M1"))).ok());

    const std::string rvec =
        replaced(opencv_file(kUsualNames), kR, "[ 0, 0.006981317007977318, 0 ]");
    const auto turned = opencv(rvec);
    ASSERT_TRUE(turned.ok()) << message(turned);
    const auto matrix = opencv(opencv_file(kUsualNames));
    EXPECT_LT(difference(turned->rig.T_left_right, matrix->rig.T_left_right).norm(), 1e-12);
    EXPECT_TRUE(has_note(turned, "read as a rotation vector"));
    EXPECT_TRUE(contains(message(opencv(replaced(opencv_file(kUsualNames), kR, "[0, 1, 0, 0]"))),
                         "R: found 4 numbers; a rotation matrix has 9, a rotation vector 3"));

    const std::string D = "[ -0.17, 0.03, 0.001, -0.0005, 0 ]";
    const auto with_D = [&](const char* text) {
        return opencv(replaced(opencv_file(kUsualNames), D, text));
    };
    EXPECT_TRUE(has_note(with_D("[ -0.01, 0.002, 0.001, -0.0005 ]"), "add 'fisheye: 1'"));
    EXPECT_FALSE(has_note(with_D("[ 0, 0, 0, 0 ]"), "fisheye"));
    const auto padded = with_D("[ -0.17, 0.03, 0.001, -0.0005, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 ]");
    ASSERT_TRUE(padded.ok()) << message(padded);
    EXPECT_EQ(pinhole(padded->rig.left).k1, -0.17);
    EXPECT_TRUE(
        contains(message(with_D("[ -0.17, 0.03, 0.001, -0.0005, 0, 0, 0, 0, 0.001, 0, 0, 0 ]")),
                 "D1: coefficient 9 is 0.001 (s1); thin-prism and tilt terms"));
    EXPECT_TRUE(contains(message(with_D("[ -0.1, 0.03, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.001, 0 ]")),
                         "coefficient 13 is 0.001 (taux)"));
}

}  // namespace
}  // namespace surefoot::io::testing
