// SPDX-License-Identifier: Apache-2.0
// Calibration files as users have them, after public reports of users of similar programs. The
// tests check the values that are read, and the message if a file cannot be a rig.
#include <gtest/gtest.h>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

constexpr double kExact = 1e-12;
/// Files print rotations with seven digits and baselines with micrometres.
constexpr double kPrinted_m = 1e-6;

std::string message(const Result<RigFile>& file) {
    return file.ok() ? "accepted" : file.error().message;
}

bool has_note(const Result<RigFile>& file, const std::string& part) {
    if (!file.ok()) return false;
    for (const std::string& note : file->notes) {
        if (contains(note, part)) return true;
    }
    return false;
}

double baseline_m(const Result<RigFile>& file) {
    return file.ok() ? file->rig.T_left_right.translation_m.norm() : -1.0;
}

const camera::PinholeRadTan& pinhole(const camera::Camera& camera) {
    return std::get<camera::PinholeRadTan>(camera.model);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    for (; at != text.npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
    return text;
}

// ---- ROS -----------------------------------------------------------------------------------

constexpr const char* kD = "[0.05, 0.17, -0.001, 0.001, -0.7]";

/// A file of camera_calibration_parsers: f 721.13 px, baseline 43.84 / 721.13 = 60.79 mm.
std::string ros_file(const std::string& offset, const std::string& more = "") {
    return "image_width: 752\nimage_height: 480\ncamera_name: cam\n"
           "camera_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [719.87, 0, 386.1, 0, 719.73, 217.1, 0, 0, 1]\n"
           "distortion_model: plumb_bob\n"
           "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: " +
           std::string(kD) +
           "\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
           "projection_matrix:\n  rows: 3\n  cols: 4\n"
           "  data: [721.13, 0, 387.7, " +
           offset + ", 0, 721.13, 222.4, 0, 0, 0, 1, 0]\n" + more;
}

Result<RigFile> ros_pair(const std::string& from = "", const std::string& to = "") {
    const auto text = [&](const char* offset) {
        const std::string whole = ros_file(offset);
        return from.empty() ? whole : replaced(whole, from, to);
    };
    return parse_ros_rig({text("0"), "left.yaml"}, {text("-43.84"), "right.yaml"});
}

Result<RigFile> ros_pair_with(const std::string& more) {
    return parse_ros_rig({ros_file("0", more), "left.yaml"},
                         {ros_file("-43.84", more), "right.yaml"});
}

TEST(RigVariants, RosBaselinesInAnotherUnitAreNamed) {
    const auto with_offset = [](const char* offset) {
        return message(
            parse_ros_rig({ros_file("0"), "left.yaml"}, {ros_file(offset), "right.yaml"}));
    };
    EXPECT_EQ(with_offset("-43.84"), "accepted");
    EXPECT_TRUE(contains(with_offset("-43840"),
                         "exceeds 5 m: is it in cm (then 607.9 mm), or in mm "
                         "(then 60.8 mm)?"));
    EXPECT_TRUE(
        contains(with_offset("-0.04384"), "0.061 mm is below 1 mm: is it in km (then 60.8 mm)?"));
    EXPECT_TRUE(contains(with_offset("43.84"), "element (0, 3)"));
    EXPECT_TRUE(has_note(parse_ros_rig({ros_file("0"), "l"}, {ros_file("-1500"), "r"}),
                         "2.080 m is longer than 1 m"));
}

TEST(RigVariants, RosWithoutRectificationHasParallelCameras) {
    const auto file = ros_pair("[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[0, 0, 0, 0, 0, 0, 0, 0, 0]");
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_NEAR(baseline_m(file), 43.84 / 721.13, kExact);
    EXPECT_EQ(pinhole(file->rig.left).fx_px, 719.87);
    EXPECT_EQ(pinhole(file->rig.left).k2, 0.17);
    EXPECT_TRUE(has_note(file, "not rectified"));
    const std::string zero =
        replaced(ros_file("0"), "[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[0, 0, 0, 0, 0, 0, 0, 0, 0]");
    EXPECT_TRUE(contains(message(parse_ros_rig({zero, "l"}, {ros_file("-43.84"), "r"})),
                         "of one camera is all zero"));
    EXPECT_TRUE(contains(message(ros_pair("[719.87, 0, 386.1, 0, 719.73, 217.1, 0, 0, 1]",
                                          "[0, 0, 0, 0, 0, 0, 0, 0, 0]")),
                         "camera_matrix: all zero: this camera is not calibrated"));
    const std::string no_P = "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]";
    const std::string uncalibrated =
        replaced(ros_file("0"), "[721.13, 0, 387.7, 0, 0, 721.13, 222.4, 0, 0, 0, 1, 0]", no_P);
    EXPECT_TRUE(
        contains(message(parse_ros_rig({uncalibrated, "l"}, {ros_file("-43.84"), "r"})),
                 "projection_matrix: all zero: this camera is not calibrated as one of a pair"));
}

TEST(RigVariants, RosModelsAreWhatTheirCoefficientsSay) {
    const auto with = [](const std::string& model, const std::string& D) {
        const auto text = [&](const char* offset) {
            return replaced(
                replaced(
                    ros_file(offset), "distortion_model: plumb_bob", "distortion_model: " + model),
                kD,
                D);
        };
        return parse_ros_rig({text("0"), "left.yaml"}, {text("-43.84"), "right.yaml"});
    };
    for (const char* model : {"\"\"", "none"}) {
        for (const char* D : {"[]", "[0, 0, 0, 0, 0]"}) {
            const auto ideal = with(model, D);
            ASSERT_TRUE(ideal.ok()) << model << D << message(ideal);
            EXPECT_FALSE(pinhole(ideal->rig.left).has_distortion());
        }
        EXPECT_TRUE(
            contains(message(with(model, kD)), "the coefficients are not 0, but distortion_model"));
    }
    const auto padded = with("plumb_bob", "[-0.03, 0.035, -0.00014, -0.00015, -0.012, 0, 0, 0]");
    ASSERT_TRUE(padded.ok()) << message(padded);
    EXPECT_EQ(pinhole(padded->rig.left).k3, -0.012);
    EXPECT_TRUE(padded->notes.empty());
    const auto rational = with("plumb_bob", "[0.1, 0.2, 0.001, 0.001, 0.05, 0.1, 0.2, 0]");
    ASSERT_TRUE(rational.ok()) << message(rational);
    EXPECT_EQ(std::get<camera::PinholeRational>(rational->rig.left.model).k5, 0.2);
    EXPECT_TRUE(has_note(rational, "coefficients as rational_polynomial"));
    const std::string rational_8 = "[0.1, 0.2, 0.001, 0.001, 0.05, 0.1, 0.2, 0.05";
    EXPECT_TRUE(with("rational_polynomial", rational_8 + ", 0, 0, 0, 0, 0, 0]").ok());
    EXPECT_TRUE(contains(message(with("rational_polynomial", rational_8 + ", 0.001, 0, 0, 0]")),
                         "coefficient 9 is 0.001 (s1); thin-prism"));
    EXPECT_TRUE(with("equidistant", "[0.1, 0.01, 0.001, 0.001, 0]").ok());
    EXPECT_TRUE(
        contains(message(with("equidistant", kD)), "5 numbers; the equidistant model has 4"));
}

TEST(RigVariants, RosBinningAndRegionAreApplied) {
    const std::string no_roi =
        "roi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n  do_rectify: false\n";
    const auto whole = ros_pair_with("binning_x: 1\nbinning_y: 0\n" + no_roi);
    ASSERT_TRUE(whole.ok()) << message(whole);
    EXPECT_EQ(whole->rig.left.width, 752);
    EXPECT_TRUE(whole->notes.empty());

    const auto binned = ros_pair_with("binning_x: 2\nbinning_y: 2\n" + no_roi);
    ASSERT_TRUE(binned.ok()) << message(binned);
    EXPECT_EQ(binned->rig.left.width, 376);
    EXPECT_EQ(binned->rig.right->height, 240);
    EXPECT_NEAR(pinhole(binned->rig.left).fx_px, 719.87 / 2, kExact);
    // The centre of the image stays its centre: (752 - 1) / 2 becomes (376 - 1) / 2.
    EXPECT_NEAR(pinhole(binned->rig.left).cx_px, (386.1 + 0.5) / 2 - 0.5, kExact);
    EXPECT_NEAR(baseline_m(binned), 43.84 / 721.13, kExact);
    EXPECT_TRUE(has_note(binned, "for images of 376 x 240 px"));

    const auto part = ros_pair_with(
        "roi:\n  x_offset: 100\n  y_offset: 60\n  height: 240\n  width: 400\n  do_rectify: true\n");
    ASSERT_TRUE(part.ok()) << message(part);
    EXPECT_EQ(part->rig.left.width, 400);
    EXPECT_EQ(part->rig.left.height, 240);
    EXPECT_NEAR(pinhole(part->rig.left).cx_px, 286.1, kExact);
    EXPECT_NEAR(pinhole(part->rig.left).cy_px, 157.1, kExact);
    EXPECT_EQ(pinhole(part->rig.left).fx_px, 719.87);

    EXPECT_TRUE(
        contains(message(ros_pair_with("roi:\n  x_offset: 500\n  y_offset: 0\n  height: 240\n"
                                       "  width: 400\n")),
                 "roi: 400 x 240 px at (500, 0) is not inside the image of 752 x 480 px"));
    EXPECT_TRUE(
        contains(message(ros_pair_with("binning_x: 5\nbinning_y: 1\n")), "cannot be binned"));
    EXPECT_TRUE(contains(message(ros_pair_with("binning_x: -2\n")), "binning_x: -2 is outside"));
}

/// As `ros2 topic echo` prints a CameraInfo, with its header and the line behind it.
std::string echo_ros2(const std::string& offset) {
    const auto list = [](const std::string& key, const std::vector<std::string>& values) {
        std::string out = key + ":\n";
        for (const std::string& value : values) out += "- " + value + "\n";
        return out;
    };
    return "header:\n  stamp:\n    sec: 1718923245\n    nanosec: 746549891\n  frame_id: cam\n"
           "height: 480\nwidth: 752\ndistortion_model: plumb_bob\n" +
           list("d", {"0.0547", "0.1797", "-0.00099", "0.00118", "-0.729"}) +
           list("k", {"719.87", "0", "386.1", "0", "719.73", "217.1", "0", "0", "1"}) +
           list("r", {"1", "0", "0", "0", "1", "0", "0", "0", "1"}) +
           list("p",
                {"721.13", "0", "387.7", offset, "0", "721.13", "222.4", "0", "0", "0", "1", "0"}) +
           "binning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n"
           "  width: 0\n  do_rectify: false\n---\n";
}

TEST(RigVariants, PrintedRosMessagesAreRead) {
    const auto ros1 = [](const char* offset) {
        return std::string(
                   "header: \n  seq: 43821\n  stamp: \n    secs: 4398\n    nsecs: 200000000\n"
                   "  frame_id: \"cam\"\nheight: 480\nwidth: 752\n"
                   "distortion_model: \"plumb_bob\"\n"
                   "D: [0.0547, 0.1797, -0.00099, 0.00118, -0.729]\n"
                   "K: [719.87, 0, 386.1, 0, 719.73, 217.1, 0, 0, 1]\n"
                   "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: [721.13, 0, 387.7, ") +
               offset + ", 0, 721.13, 222.4, 0, 0, 0, 1, 0]\nbinning_x: 0\nbinning_y: 0\n---\n";
    };
    const auto tags = [](const char* offset) {
        return "%YAML:1.0\n---\n" +
               replaced(replaced(replaced(replaced(ros_file(offset),
                                                   "camera_matrix:\n",
                                                   "camera_matrix: !!opencv-matrix\n"),
                                          "distortion_coefficients:\n",
                                          "distortion_coefficients: !!opencv-matrix\n"),
                                 "rectification_matrix:\n",
                                 "rectification_matrix: !!opencv-matrix\n"),
                        "projection_matrix:\n",
                        "projection_matrix: !!opencv-matrix\n");
    };
    const testing::TemporaryFolder folder;
    const auto read = [&](const std::string& left, const std::string& right) {
        EXPECT_TRUE(write_file(folder / "left.yaml", left).ok());
        EXPECT_TRUE(write_file(folder / "right.yaml", right).ok());
        return read_rig_file(folder.path());
    };
    for (const auto& file : {read(echo_ros2("0"), echo_ros2("-43.84")),
                             read(ros1("0"), ros1("-43.84")),
                             read(tags("0"), tags("-43.84"))}) {
        ASSERT_TRUE(file.ok()) << message(file);
        EXPECT_EQ(file->format, RigFormat::ros);
        EXPECT_EQ(file->rig.left.width, 752);
        EXPECT_EQ(pinhole(file->rig.left).fy_px, 719.73);
        EXPECT_NEAR(baseline_m(file), 43.84 / 721.13, kExact);
        EXPECT_TRUE(file->notes.empty());
    }
}

// ---- OpenCV --------------------------------------------------------------------------------

struct Names {
    const char *K1, *D1, *K2, *D2, *R, *T;
};
constexpr Names kUsualNames{"M1", "D1", "M2", "D2", "R", "T"};
constexpr const char* kR =
    "[ 0.9999756307053949, 0, 0.006981260297961553, 0, 1, 0, -0.006981260297961553, 0, "
    "0.9999756307053949 ]";

std::string opencv_file(const Names& names, const std::string& T = "[ -0.12, 0.0004, 0.0002 ]") {
    const auto matrix = [](const std::string& key, const char* size, const std::string& data) {
        return key + ": !!opencv-matrix\n   " + size + "\n   dt: d\n   data: " + data + "\n";
    };
    return "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 720\n" +
           matrix(names.K1, "rows: 3\n   cols: 3", "[ 700, 0, 640, 0, 700, 360, 0, 0, 1 ]") +
           matrix(names.D1, "rows: 1\n   cols: 5", "[ -0.17, 0.03, 0.001, -0.0005, 0 ]") +
           matrix(names.K2, "rows: 3\n   cols: 3", "[ 702, 0, 642, 0, 702, 358, 0, 0, 1 ]") +
           matrix(names.D2, "rows: 1\n   cols: 5", "[ -0.17, 0.03, 0.001, -0.0005, 0 ]") +
           matrix(names.R, "rows: 3\n   cols: 3", kR) + matrix(names.T, "rows: 3\n   cols: 1", T);
}

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
    EXPECT_EQ(
        message(opencv(replaced(opencv_file(kUsualNames), "M2:", "N2:"))),
        "stereo.yml:3: camera matrix of the right camera: not found; the key of the other "
        "camera is 'M1'. The two keys may differ only in 1 and 2, left and right, or l and r");
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

TEST(RigVariants, AFocalLengthInMillimetresIsSaid) {
    const auto file = parse_rig_file(
        "resolution: [640, 480]\nbaseline_m: 0.12\nfocal_px: 4.2\nprincipal_px: [320, 240]\n",
        "rig.yaml");
    EXPECT_TRUE(file.ok()) << message(file);
    EXPECT_TRUE(
        has_note(file, "focal length 4.20 px is too short for an image of 640 px: is it in mm?"));
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
                         "R: 4 numbers; a rotation matrix has 9, a rotation vector 3"));

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

// ---- ORB-SLAM ------------------------------------------------------------------------------

const std::string kOrbSlam3 =
    "%YAML:1.0\n\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n"
    "Camera1.fx: 458.654\nCamera1.fy: 457.296\nCamera1.cx: 367.215\nCamera1.cy: 248.375\n"
    "Camera1.k1: -0.28340811\nCamera1.k2: 0.07395907\nCamera1.p1: 0.00019359\n"
    "Camera1.p2: 1.76187114e-05\n"
    "Camera2.fx: 457.587\nCamera2.fy: 456.134\nCamera2.cx: 379.999\nCamera2.cy: 255.238\n"
    "Camera2.k1: -0.28368365\nCamera2.k2: 0.07451284\nCamera2.p1: -0.00010473\n"
    "Camera2.p2: -3.55590700e-05\n"
    "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20\nCamera.RGB: 1\nStereo.ThDepth: 60.0\n"
    "Stereo.T_c1_c2: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: f\n"
    "  data: [0.999997256477797,-0.002317135723275,-0.000343393120620,0.110074137800478,"
    "0.002312067192432,0.999898048507103,-0.014090668452683,-0.000156612054392,"
    "0.000376008102320,0.014089835846691,0.999900662638081,0.000889382785432,0,0,0,1.0]\n";

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

const std::string kOrbSlam2 =
    "%YAML:1.0\n\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.5\nCamera.cy: 252.2\n"
    "Camera.k1: 0.0\nCamera.k2: 0.0\nCamera.p1: 0.0\nCamera.p2: 0.0\n"
    "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20.0\nCamera.bf: 47.906\n";

std::string orbslam2_side(const std::string& side, const char* offset) {
    // Without a blank behind "data:", as ORB-SLAM2's own examples have it.
    return side +
           ".D: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
           "   data:[-0.28, 0.07, 0.0002, 1.8e-05, 0.0]\n" +
           side +
           ".K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
           "   data: [458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0]\n" +
           side +
           ".R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
           "   data: [0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8]\n" +
           side +
           ".P: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n"
           "   data: [435.2, 0.0, 367.5, " +
           offset + ", 0.0, 435.2, 252.2, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
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

// ---- KITTI, Middlebury ---------------------------------------------------------------------

const std::string kKittiRaw =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\n"
    "S_00: 1.392000e+03 5.120000e+02\n"
    "K_00: 9.842439e+02 0 6.900000e+02 0 9.808141e+02 2.331966e+02 0 0 1\n"
    "D_00: -3.728755e-01 2.037299e-01 2.219027e-03 1.383707e-03 -7.233722e-02\n"
    "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 2.573699e-16 -1.059758e-16 1.614870e-16\n"
    "S_rect_00: 1.242000e+03 3.750000e+02\n"
    "R_rect_00: 9.999239e-01 9.837760e-03 -7.445048e-03 -9.869795e-03 9.999421e-01 -4.278459e-03 "
    "7.402527e-03 4.351614e-03 9.999631e-01\n"
    "P_rect_00: 7.215377e+02 0 6.095593e+02 0 0 7.215377e+02 1.728540e+02 0 0 0 1 0\n"
    "S_01: 1.392000e+03 5.120000e+02\n"
    "K_01: 9.895267e+02 0 7.020000e+02 0 9.878386e+02 2.455590e+02 0 0 1\n"
    "D_01: -3.644661e-01 1.790019e-01 1.148107e-03 -6.298563e-04 -5.314062e-02\n"
    "R_01: 9.993513e-01 1.860866e-02 -3.083487e-02 -1.887662e-02 9.997863e-01 -8.421873e-03 "
    "3.067156e-02 8.998467e-03 9.994890e-01\n"
    "T_01: -5.370000e-01 4.822061e-03 -1.252488e-02\n"
    "P_rect_01: 7.215377e+02 0 6.095593e+02 -3.875744e+02 0 7.215377e+02 1.728540e+02 0 0 0 1 0\n";

TEST(RigVariants, KittiRawIsRead) {
    const auto file = parse_rig_file(kKittiRaw, "calib_cam_to_cam.txt");
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(file->format, RigFormat::kitti_raw);
    EXPECT_NEAR(baseline_m(file), 387.5744 / 721.5377, kExact);
    EXPECT_TRUE(file->rig.rectified);
    EXPECT_EQ(file->rig.left.width, 1242);
    EXPECT_TRUE(has_note(file, "cameras 0 and 1 (grey)"));

    const auto raw = parse_rig_file(kKittiRaw, "calib_cam_to_cam.txt", ImageSize{1392, 512});
    ASSERT_TRUE(raw.ok()) << message(raw);
    EXPECT_FALSE(raw->rig.rectified);
    EXPECT_EQ(pinhole(raw->rig.left).k3, -7.233722e-02);
    EXPECT_NEAR(baseline_m(raw), 0.5372, 1e-4);
    EXPECT_TRUE(has_note(raw, "raw images"));

    EXPECT_TRUE(
        contains(message(parse_rig_file(kKittiRaw.substr(0, kKittiRaw.find("P_rect_01")), "c.txt")),
                 "c.txt: the line 'P_rect_01:' is missing"));
    EXPECT_TRUE(
        contains(message(parse_rig_file(
                     replaced(kKittiRaw, "S_rect_00: 1.242000e+03", "S_rect_00:"), "c.txt")),
                 "S_rect_00: 1 numbers; exactly 2"));
    EXPECT_TRUE(contains(message(parse_rig_file(
                             "calib_time: 25-May-2012\nR: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n", "i.txt")),
                         "laser scanner or the IMU; give calib_cam_to_cam.txt"));
}

TEST(RigVariants, KittiObjectFilesAreRead) {
    const std::string text =
        "P0: 721.5 0 609.6 0 0 721.5 172.9 0 0 0 1 0\nP1: 721.5 0 609.6 -387.6 0 721.5 172.9 0 0 0 "
        "1 0\n"
        "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";
    const auto file = parse_rig_file(text, "000000.txt", ImageSize{1242, 375});
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_NEAR(baseline_m(file), 387.6 / 721.5, kExact);
    EXPECT_TRUE(contains(message(parse_rig_file(text, "000000.txt")), "--resolution WIDTHxHEIGHT"));
    const auto colour = parse_rig_file(
        "P2: 721.5 0 609.6 44.9 0 721.5 172.9 0 0 0 1 0\n"
        "P3: 721.5 0 609.6 -339.5 0 721.5 172.9 0 0 0 1 0\n",
        "000000.txt",
        ImageSize{1242, 375});
    EXPECT_NEAR(baseline_m(colour), 384.4 / 721.5, kExact);
}

const std::string kMiddlebury =
    "cam0=[4161.221 0 1445.577; 0 4161.221 984.686; 0 0 1]\n"
    "cam1=[4161.221 0 1654.636; 0 4161.221 984.686; 0 0 1]\n"
    "doffs=209.059\nbaseline=176.252\nwidth=2880\nheight=1988\nndisp=280\nisint=0\nvmin=25\n"
    "vmax=248\ndyavg=0\ndymax=0\n";

TEST(RigVariants, MiddleburyIsRead) {
    const auto file = parse_rig_file(kMiddlebury, "calib.txt");
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(file->format, RigFormat::middlebury);
    EXPECT_NEAR(baseline_m(file), 0.176252, kExact);
    EXPECT_NEAR(pinhole(*file->rig.right).cx_px - pinhole(file->rig.left).cx_px, 209.059, 1e-9);
    EXPECT_EQ(file->rig.left.width, 2880);
    EXPECT_TRUE(has_note(file, "doffs = 209.059 px"));
    // A point 4 m ahead: the disparity of the set is f b / z - doffs.
    const Eigen::Vector3d p(0.1, 0.0, 4.0);
    const double disparity_px =
        project(file->rig.left.model, p)->x() -
        project(file->rig.right->model, file->rig.T_left_right.inverse() * p)->x();
    EXPECT_NEAR(disparity_px, 4161.221 * 0.176252 / 4.0 - 209.059, 1e-9);

    const auto bad = [](const char* from, const char* to) {
        return message(parse_rig_file(replaced(kMiddlebury, from, to), "calib.txt"));
    };
    EXPECT_TRUE(contains(bad("doffs=209.059", "doffs=29.059"), "doffs is 29.059 px, but"));
    EXPECT_TRUE(contains(bad("width=2880\n", ""), "calib.txt: the line 'width=' is missing"));
    EXPECT_TRUE(contains(bad("baseline=176.252", "baseline=0.176"), "0.176 mm is below 1 mm"));
    EXPECT_TRUE(
        contains(bad("cam1=[4161.221", "cam1=[x"), "calib.txt:2: cam1: 'x' is not a number"));
}

// ---- Kalibr, ZED ---------------------------------------------------------------------------

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

std::string zed_lens(const char* prism) {
    return std::string(
               "k1=1.21\nk2=0.30\np1=0.0001\np2=-0.0002\nk3=0.01\nk4=1.55\nk5=0.55\nk6=0.06\n") +
           prism;
}

std::string zed_file(const char* prism) {
    return "[LEFT_CAM_HD]\nfx=738.1\nfy=738.0\ncx=641.2\ncy=361.7\n"
           "[RIGHT_CAM_HD]\nfx=737.9\nfy=737.8\ncx=640.9\ncy=360.8\n"
           "[LEFT_DISTO]\n" +
           zed_lens(prism) + "[RIGHT_DISTO]\n" + zed_lens(prism) +
           "[STEREO]\nBaseline=119.87\nTY=0.02\nTZ=-0.31\nRX_HD=0.0004\nCV_HD=0.001\nRZ_HD=-0."
           "0002\n";
}

TEST(RigVariants, ZedThinPrismTermsAreNotLeftOut) {
    EXPECT_EQ(message(parse_rig_file(zed_file("s1=0\ns2=0\ns3=0\ns4=0\n"), "SN1.conf")),
              "accepted");
    EXPECT_TRUE(
        contains(message(parse_rig_file(zed_file("s1=0.0021\ns2=0\ns3=0\ns4=0\n"), "SN1.conf")),
                 "SN1.conf: [LEFT_DISTO] coefficient 9 is 0.0021 (s1); thin-prism"));
    EXPECT_TRUE(
        contains(message(parse_rig_file(zed_file("s4=-0.0003\n"), "SN1.conf")), "coefficient 12"));
}

TEST(RigVariants, ZedFilesOfAnyAge) {
    const std::string mode =
        "fx=699.0\nfy=699.0\ncx=626.75\ncy=360.9\nk1=-0.173733\nk2=0.0272837\n";
    const auto file = [&](const std::string& stereo, const std::string& head = "") {
        return parse_rig_file(
            head + "[LEFT_CAM_HD]\n" + mode + "[RIGHT_CAM_HD]\n" + mode + "[STEREO]\n" + stereo,
            "SN.conf");
    };
    const std::string stereo =
        "Baseline=120.123\nTY=-0.08\nTZ=-0.03\nCV_HD=0.00996\nRX_HD=0.001\nRZ_HD=0.001\n";
    EXPECT_TRUE(file(stereo).ok()) << message(file(stereo));
    EXPECT_TRUE(file(replaced(stereo, "CV_HD", "RY_HD")).ok());
    EXPECT_TRUE(file(stereo, ";comment\n#c\n").ok());
    EXPECT_TRUE(file(replaced(stereo, "\n", "\r\n")).ok());
    EXPECT_TRUE(parse_rig_file(replaced("[left_cam_hd]\n" + mode + "[right_cam_hd]\n" + mode +
                                            "[stereo]\n" + stereo,
                                        "Baseline",
                                        "baseline"),
                               "SN.conf")
                    .ok());
    EXPECT_TRUE(contains(message(file(replaced(stereo, "TY=-0.08\n", ""))),
                         "[STEREO] has no 'TY_HD'. Download the file of this serial number again"));
    EXPECT_TRUE(contains(message(file(replaced(stereo, "RX_HD=0.001\n", ""))),
                         "or add the line 'RX_HD = 0'"));
}

// ---- Files that are not calibrations --------------------------------------------------------

TEST(RigVariants, AFileIsNeverJudgedByTheKeysOfAnotherFormat) {
    struct Case {
        const char* text;
        const char* says;
    };
    const Case cases[] = {
        {"T_BS:\n  data: [1]\n", "looks like the sensor.yaml of one EuRoC sensor; give the folder"},
        {"model_type: PINHOLE\nprojection_parameters:\n  fx: 1\n",
         "a VINS or camodocal calibration"},
        {"value0:\n  T_imu_cam: []\n",
         "a Basalt calibration; this format is not supported. Give the Kalibr"},
        {"cameras:\n- {T_SC: [1]}\n", "an OKVIS configuration"},
        {"name: rex\nsole_depth_m: 1\nmovements: []\n",
         "a machine file of Surefoot; give it with --machine"},
        {"odometry:\n  x: 1\nelevation:\n  y: 2\n",
         "a settings file of Surefoot; give it with --config"},
        {"alpha: 1\nbeta: 2\n",
         "not a known calibration format (first keys of the file: 'alpha', 'beta'). Known "
         "formats:"},
        {"", "not a known calibration format. Known formats:"},
        {"- 1\n- 2\n", "not a known calibration format"},
    };
    for (const Case& c : cases) {
        const std::string said = message(parse_rig_file(c.text, "x.yaml"));
        EXPECT_TRUE(contains(said, c.says)) << said;
        EXPECT_TRUE(said.starts_with("x.yaml: ")) << said;
        for (const char* key : {"focal_px", "T_left_right", "principal_px"}) {
            EXPECT_FALSE(contains(said, key)) << said;
        }
    }
    EXPECT_TRUE(contains(message(parse_rig_file(std::string("PK\0\3", 4), "rig.npz")),
                         "looks like a binary file; write the matrices into a YAML file"));
    // A rig.yaml with an error is checked against its own keys.
    EXPECT_TRUE(contains(
        message(parse_rig_file("resolution: [672, 376]\nfocal: 350\nrate_hz: 15\n", "rig.yaml")),
        "unknown key 'focal'; did you mean 'focal_px'?"));
}

TEST(RigVariants, AFolderIsAskedForItsCalibration) {
    const testing::TemporaryFolder folder;
    EXPECT_TRUE(contains(message(read_rig_file(folder.path())), "this folder has no calibration"));
    ASSERT_TRUE(write_file(folder / "calib.txt", kMiddlebury).ok());
    EXPECT_EQ(message(read_rig_file(folder.path())), "accepted");
    ASSERT_TRUE(write_file(folder / "left.yaml", kOrbSlam3).ok());
    EXPECT_TRUE(
        contains(message(read_rig_file(folder.path())),
                 "left.yaml: this looks like an ORB-SLAM settings file, not like one camera"));
}

TEST(RigVariants, OurOwnFileSaysHowADepthCameraIsWritten) {
    const std::string one =
        "resolution: [640, 480]\nleft: {model: pinhole, focal_px: [525, 525], principal_px: "
        "[319.5, 239.5]}\n";
    EXPECT_EQ(
        message(parse_rig_file(one, "rig.yaml")),
        "rig.yaml:1: right: this key is missing; a camera that measures depth itself (RGB-D) needs "
        "'layout: rgbd' and no second camera");
    const auto rgbd = parse_rig_file("layout: rgbd\n" + one, "rig.yaml");
    ASSERT_TRUE(rgbd.ok()) << message(rgbd);
    EXPECT_FALSE(rgbd->rig.right);
    const std::string padded = replaced(
        "layout: rgbd\n" + one, "239.5]", "239.5], coefficients: [0.1, 0, 0, 0, 0, 0, 0, 0]");
    EXPECT_EQ(message(parse_rig_file(padded, "rig.yaml")), "accepted")
        << "zeros at the end of a list";
}

TEST(RigVariants, SurviveDamagedFiles) {
    const auto sound = [](const Result<RigFile>& file) {
        if (file.ok()) {
            EXPECT_FALSE(file->rig.problem().has_value());
        } else {
            EXPECT_FALSE(file.error().message.empty());
        }
    };
    std::uint64_t seed = 40;
    for (const std::string& text :
         {kOrbSlam3,
          kOrbSlam2 + orbslam2_side("LEFT", "0.0") + orbslam2_side("RIGHT", "-47.9"),
          kKittiRaw,
          kMiddlebury,
          opencv_file(kUsualNames),
          zed_file("s1=0\n")}) {
        testing::for_each_mutation(text, 1000, ++seed, [&](const std::string& damaged) {
            sound(parse_rig_file(damaged, "damaged", ImageSize{1280, 720}));
        });
    }
    testing::for_each_mutation(
        ros_file("-43.84", "binning_x: 2\nroi: {x_offset: 1, width: 9, height: 8}\n"),
        1000,
        ++seed,
        [&](const std::string& damaged) {
            sound(parse_ros_rig({ros_file("0"), "l"}, {damaged, "r"}));
        });
}

}  // namespace
}  // namespace surefoot::io
