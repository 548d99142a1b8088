// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/rig_formats.hpp"

#include <gtest/gtest.h>

#include <locale>
#include <opencv2/core.hpp>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

/// Tolerance: printed doubles read back exactly, but a pose goes through a matrix or a rotation
/// vector and its inverse.
constexpr double kPoseRounding = 2e-14;
/// This tolerance in pixels, for f < 1000 px.
constexpr double kPixelRounding_px = 1e-10;

template <typename T>
std::string message(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

enum class Lens { ideal, radtan4, radtan5, rational, fisheye };

camera::CameraModel lens(Lens kind, double f) {
    switch (kind) {
        case Lens::ideal: return camera::PinholeRadTan{f, f, 330, 190};
        case Lens::radtan4:
            return camera::PinholeRadTan{f, f + 1.5, 330, 190, -0.17, 0.026, 6e-5, -1.5e-4};
        case Lens::radtan5:
            return camera::PinholeRadTan{f, f + 1.5, 330, 190, -0.17, 0.026, 6e-5, -1.5e-4, 1e-3};
        case Lens::rational:
            return camera::PinholeRational{
                f, f + 1.5, 330, 190, 0.72, 0.085, 6e-4, -4e-4, 0.0011, 1.04, 0.22, 0.012};
        case Lens::fisheye:
            return camera::KannalaBrandt{f, f + 1.5, 330, 190, 0.0121, 0.0056, -0.0061, 0.0005};
    }
    return {};
}

/// A rig with the image size of a ZED and a small rotation; with ideal lenses it is rectified.
camera::StereoRig rig_with(Lens kind) {
    camera::StereoRig rig;
    rig.name = "test";
    const double other_px = kind == Lens::ideal ? 0.0 : 0.7;
    rig.left = {lens(kind, 350.25), 672, 376};
    rig.right = camera::Camera{lens(kind, 350.25 + other_px), 672, 376};
    rig.T_left_right.translation_m = {0.119978, 0.0, 0.0};
    rig.rectified = kind == Lens::ideal;
    if (rig.rectified) return rig;
    rig.T_left_right = {exp_so3({-0.0009, 0.0062, 0.0008}), {0.119978, 2.6e-4, -1.6e-4}};
    rig.imu = camera::ImuMount{Pose{exp_so3({0.3, -0.2, 0.1}), {0.01, -0.02, 0.03}}, 400.0};
    return rig;
}

/// The purpose of a calibration: the pixels at which both cameras see a point.
void expect_same_geometry(const camera::StereoRig& a, const camera::StereoRig& b) {
    EXPECT_EQ(a.left.width, b.left.width);
    EXPECT_EQ(a.right->height, b.right->height);
    EXPECT_EQ(a.left.model.index(), b.left.model.index());
    EXPECT_EQ(a.right->model.index(), b.right->model.index());
    EXPECT_EQ(a.rectified, b.rectified);
    EXPECT_LT(difference(a.T_left_right, b.T_left_right).norm(), kPoseRounding);
    for (double x = -0.7; x < 0.8; x += 0.2) {
        const Eigen::Vector3d p(2.0 * x, 0.5 - x, 2.0);
        EXPECT_EQ(project(a.left.model, p), project(b.left.model, p)) << p.transpose();
        const auto in_a = project(a.right->model, a.T_left_right.inverse() * p);
        const auto in_b = project(b.right->model, b.T_left_right.inverse() * p);
        ASSERT_EQ(in_a.has_value(), in_b.has_value());
        if (!in_a) continue;
        EXPECT_LT((*in_a - *in_b).norm(), kPixelRounding_px) << p.transpose();
    }
}

struct Holds {
    RigFormat format;
    std::vector<Lens> lenses;
    std::vector<Lens> refused;
};

/// Lenses that each format can store.
std::vector<Holds> formats() {
    return {{RigFormat::surefoot,
             {Lens::ideal, Lens::radtan4, Lens::radtan5, Lens::rational, Lens::fisheye},
             {}},
            {RigFormat::opencv,
             {Lens::ideal, Lens::radtan4, Lens::radtan5, Lens::rational, Lens::fisheye},
             {}},
            {RigFormat::ros,
             {Lens::ideal, Lens::radtan4, Lens::radtan5, Lens::rational, Lens::fisheye},
             {}},
            {RigFormat::kalibr,
             {Lens::ideal, Lens::radtan4, Lens::fisheye},
             {Lens::radtan5, Lens::rational}},
            {RigFormat::zed,
             {Lens::ideal, Lens::radtan4, Lens::radtan5, Lens::rational},
             {Lens::fisheye}}};
}

TEST(RigFormats, EveryLensReturnsFromEveryFormatThatHoldsIt) {
    const testing::TemporaryFolder folder;
    for (const Holds& holds : formats()) {
        for (const Lens kind : holds.lenses) {
            SCOPED_TRACE(std::string(name_of(holds.format)) + " lens " +
                         std::to_string(static_cast<int>(kind)));
            const camera::StereoRig rig = rig_with(kind);
            const bool conf = holds.format == RigFormat::zed;
            const auto files =
                write_rig(folder / (conf ? "SN1.conf" : "cam_left.yaml"), rig, holds.format);
            ASSERT_TRUE(files.ok()) << message(files);
            EXPECT_EQ(files->size(), holds.format == RigFormat::ros ? 2U : 1U);
            const auto back = read_rig_file(files->front());
            ASSERT_TRUE(back.ok()) << message(back);
            EXPECT_EQ(back->format, holds.format);
            expect_same_geometry(rig, back->rig);
        }
        for (const Lens kind : holds.refused) {
            const auto files = write_rig(folder / "refused", rig_with(kind), holds.format);
            EXPECT_TRUE(contains(message(files), folder / "refused: ")) << message(files);
            EXPECT_FALSE(is_file(folder / "refused"));
        }
    }
}

TEST(RigFormats, EurocHoldsRationalLensesToo) {
    const EurocCamera camera{rig_with(Lens::rational).left, Pose{}, 20.0, 0.0};
    const auto back = parse_euroc_camera(format_euroc_camera(camera), "sensor.yaml");
    ASSERT_TRUE(back.ok()) << message(back);
    const Eigen::Vector3d p(0.3, -0.2, 1.0);
    EXPECT_EQ(project(back->camera.model, p), project(camera.camera.model, p));
    EXPECT_EQ(back->camera.model.index(), camera.camera.model.index());
}

TEST(RigFormats, WhatAFormatCannotHoldIsSaid) {
    camera::StereoRig rig = rig_with(Lens::radtan4);
    rig.rate_hz = 15.0;
    rig.readout_s = 0.01;
    rig.T_body_left = T_body_optical();
    EXPECT_TRUE(lost_in(RigFormat::surefoot, rig).empty());
    EXPECT_EQ(lost_in(RigFormat::opencv, rig),
              (std::vector<std::string>{"T_body_left", "imu", "rate_hz 15", "readout_s 0.01"}));
    EXPECT_EQ(lost_in(RigFormat::kalibr, rig),
              (std::vector<std::string>{"T_body_left", "rate_hz 15", "readout_s 0.01"}));
    rig.right.reset();
    const testing::TemporaryFolder folder;
    for (const RigFormat format :
         {RigFormat::opencv, RigFormat::kalibr, RigFormat::ros, RigFormat::zed}) {
        EXPECT_TRUE(contains(message(write_rig(folder / "x.yaml", rig, format)), "one camera"));
    }
    rig.left.model = camera::PinholeRadTan{0.0, 1.0, 3.0, 3.0};
    EXPECT_TRUE(contains(message(write_rig(folder / "x.yaml", rig, RigFormat::surefoot)),
                         "cannot be written"));
    EXPECT_FALSE(write_rig("/dev/full", rig_with(Lens::ideal), RigFormat::opencv).ok());
}

TEST(RigOpenCvWriter, FileStorageReadsIt) {
    const camera::StereoRig rig = rig_with(Lens::rational);
    const auto text = format_opencv_rig(rig);
    ASSERT_TRUE(text.ok()) << message(text);
    const cv::FileStorage file(*text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    ASSERT_TRUE(file.isOpened());
    EXPECT_EQ(static_cast<int>(file["image_width"]), 672);
    const auto matrix = [&](const char* key) {
        const cv::Mat m = file[key].mat();
        EXPECT_EQ(m.type(), CV_64F) << key;
        return m;
    };
    const auto& left = std::get<camera::PinholeRational>(rig.left.model);
    EXPECT_EQ(matrix("M1").at<double>(0, 0), left.fx_px);
    EXPECT_EQ(matrix("M1").at<double>(1, 2), left.cy_px);
    EXPECT_EQ(matrix("D1").size(), cv::Size(8, 1));
    EXPECT_EQ(matrix("D1").at<double>(7), left.k6);
    EXPECT_EQ(matrix("P1").size(), cv::Size(4, 3));
    // A point behind the rectified pair: both rows agree, and Q turns the disparity back into it.
    const auto rectifier = camera::Rectifier::make(rig);
    ASSERT_TRUE(rectifier.ok());
    const cv::Matx33d R1(matrix("R1"));
    const cv::Matx33d R2(matrix("R2"));
    const cv::Matx33d R(matrix("R"));
    const cv::Vec3d T(matrix("T"));
    const cv::Vec3d p_left(0.4, -0.3, 1.7);
    const cv::Vec3d p_rectified = R1 * p_left;
    const cv::Vec3d p_right = R2 * (R * p_left + T);
    const auto project_with = [](const cv::Mat& P, const cv::Vec3d& p) {
        const cv::Matx34d M(P);
        const cv::Vec3d h = M * cv::Vec4d(p[0], p[1], p[2], 1.0);
        return cv::Vec2d(h[0] / h[2], h[1] / h[2]);
    };
    const cv::Vec2d in_left = project_with(matrix("P1"), p_rectified);
    const cv::Vec2d in_right = project_with(matrix("P2"), p_rectified);
    // P2 takes the rectified *left* frame; the right camera's own rectified frame needs P1.
    EXPECT_LT(cv::norm(in_right - project_with(matrix("P1"), p_right)), kPixelRounding_px);
    EXPECT_NEAR(in_left[1], in_right[1], kPixelRounding_px);
    const double disparity = in_left[0] - in_right[0];
    EXPECT_GT(disparity, 0.0);
    const cv::Matx44d Q(matrix("Q"));
    const cv::Vec4d h = Q * cv::Vec4d(in_left[0], in_left[1], disparity, 1.0);
    EXPECT_LT(cv::norm(cv::Vec3d(h[0], h[1], h[2]) * (1.0 / h[3]) - p_rectified), 1e-12);
}

/// After the example of Kalibr's wiki, with values of the EuRoC rig.
const std::string kKalibr =
    "cam0:\n"
    "  camera_model: pinhole\n"
    "  intrinsics: [461.629, 460.152, 362.680, 246.049]\n"
    "  distortion_model: radtan\n"
    "  distortion_coeffs: [-0.27695497, 0.06712482, 0.00087538, 0.00011556]\n"
    "  T_cam_imu:\n"
    "  - [0.0, 1.0, 0.0, 0.07]\n"
    "  - [-1.0, 0.0, 0.0, -0.02]\n"
    "  - [0.0, 0.0, 1.0, 0.004]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  timeshift_cam_imu: -8.121e-05\n"
    "  rostopic: /cam0/image_raw\n"
    "  resolution: [752, 480]\n"
    "cam1:\n"
    "  camera_model: pinhole\n"
    "  intrinsics: [460.1, 459.2, 373.850, 253.749]\n"
    "  distortion_model: equidistant\n"
    "  distortion_coeffs: [0.01, -0.02, 0.003, -0.0004]\n"
    "  T_cn_cnm1:\n"
    "  - [ 1.0, 0.0, 0.0, -0.11]\n"
    "  - [ 0.0, 0.8, -0.6, 0.0]\n"
    "  - [ 0.0, 0.6, 0.8, 0.001]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  resolution: [752, 480]\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

TEST(RigKalibr, ReadsTheExampleOfItsDocumentation) {
    const auto file = parse_kalibr_rig(kKalibr, "camchain.yaml");
    ASSERT_TRUE(file.ok()) << message(file);
    const camera::StereoRig& rig = file->rig;
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig.left.model).p2, 0.00011556);
    EXPECT_EQ(std::get<camera::KannalaBrandt>(rig.right->model).k4, -0.0004);
    // T_cn_cnm1: from cam0 to cam1. A point on cam0's axis, by hand.
    const Eigen::Vector3d p_cam1 = rig.T_left_right.inverse() * Eigen::Vector3d(0.0, 0.0, 1.0);
    EXPECT_LT((p_cam1 - Eigen::Vector3d(-0.11, -0.6, 0.801)).norm(), 1e-15);
    // T_cam_imu: from the IMU to cam0.
    ASSERT_TRUE(rig.imu && rig.T_body_left);
    const Pose T_cam0_imu = rig.T_body_left->inverse() * rig.imu->T_body_imu;
    EXPECT_LT(
        (T_cam0_imu * Eigen::Vector3d(1.0, 0.0, 0.0) - Eigen::Vector3d(0.07, -1.02, 0.004)).norm(),
        1e-15);
    ASSERT_EQ(file->notes.size(), 2U);
    EXPECT_TRUE(contains(file->notes[0], "rate of the IMU"));
    EXPECT_TRUE(contains(file->notes[1], "timeshift_cam_imu -8.121e-05 s"));
}

TEST(RigKalibr, TheImuReturns) {
    camera::StereoRig rig = rig_with(Lens::radtan4);
    rig.T_body_left = Pose{exp_so3({0.1, 0.5, -0.3}), {0.2, 0.0, 1.0}};
    const auto text = format_kalibr_rig(rig);
    ASSERT_TRUE(text.ok());
    const auto back = parse_kalibr_rig(*text, "camchain.yaml");
    ASSERT_TRUE(back.ok()) << message(back);
    const Pose before = rig.T_body_left->inverse() * rig.imu->T_body_imu;
    const Pose after = back->rig.T_body_left->inverse() * back->rig.imu->T_body_imu;
    EXPECT_LT(difference(before, after).norm(), kPoseRounding);
}

struct Bad {
    const char* from;
    const char* to;
    const char* says;
};

TEST(RigKalibr, BadValuesNameFileAndKey) {
    const std::vector<Bad> table{
        {"camera_model: pinhole",
         "camera_model: omni",
         "c.yaml:2: cam0.camera_model: 'omni' is not supported"},
        {"camera_model: pinhole",
         "camera_model: ds",
         "'ds' is not supported; calibrate with pinhole"},
        {"cam1:", "camera1:", "key 'cam1' is missing"},
        {"T_cn_cnm1:", "T_cn:", "key 'T_cn_cnm1' is missing"},
        {"461.629, 460.152, 362.680",
         "461.629, 460.152",
         "cam0.intrinsics: found 3 numbers; exactly 4"},
        {"461.629", ".nan", "cam0.intrinsics: nan is outside"},
        {"461.629",
         "0.0",
         "c.yaml:3: cam0.intrinsics: focal lengths 0 and 460.152 must be above 0"},
        {"461.629", "'461,6'", "'461,6' is not a number"},
        {"radtan", "fov", "'fov' is not one of radtan | equidistant | none"},
        {"-0.27695497, ", "", "cam0.distortion_coeffs: found 3 numbers; exactly 4"},
        {"[ 1.0, 0.0, 0.0, -0.11]",
         "[ 1.1, 0.0, 0.0, -0.11]",
         "cam1.T_cn_cnm1: not a rigid motion"},
        {"0.0, -0.11]", "0.0, 0.11]", "c.yaml: the right camera lies 0.110 m to the left"},
        {"resolution: [752, 480]", "resolution: [752]", "cam0.resolution: found 1 numbers"},
        {"resolution: [752, 480]",
         "resolution: [320, 240]",
         "c.yaml: left camera: principal point"},
        {"cam1:\n", "cam1: 5\ncam3:\n", "cam1: expected a group with camera_model"}};
    for (const Bad& bad : table) {
        const std::string said =
            message(parse_kalibr_rig(replaced(kKalibr, bad.from, bad.to), "c.yaml"));
        EXPECT_TRUE(contains(said, bad.says)) << bad.from << " -> " << bad.to << ": " << said;
    }
    EXPECT_TRUE(contains(message(parse_kalibr_rig("", "c.yaml")), "c.yaml: expected the cameras"));
    EXPECT_TRUE(contains(message(parse_kalibr_rig(std::string("\x89PNG\0\x01\xff", 7), "c.yaml")),
                         "c.yaml"));
}

/// Laid out as camera_calibration_parsers prints it. The pair: f = 400 px, baseline 0.12 m.
std::string ros_text(const char* name, const char* offset) {
    return std::string("image_width: 640\nimage_height: 480\ncamera_name: ") + name +
           "\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [410., 0., 320., 0., 411., 240., 0., 0., 1.]\n"
           "distortion_model: plumb_bob\n"
           "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.3, 0.1, 0.001, -0.002, "
           "0.]\n"
           "rectification_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [0.8, 0., 0.6, 0., 1., 0., -0.6, 0., 0.8]\n"
           "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [400., 0., 322., " +
           offset + ", 0., 400., 241., 0., 0., 0., 1., 0.]\n";
}

TEST(RigRos, PoseComesFromTheRectification) {
    const auto file = parse_ros_rig({ros_text("left", "0."), "left.yaml"},
                                    {ros_text("right", "-48."), "right.yaml"});
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(file->rig.left.model).p2, -0.002);
    // Both are turned alike: parallel cameras, 0.12 m along the rectified x axis, which the raw
    // left camera sees as R^T e_x = (0.8, 0, 0.6).
    EXPECT_LT((file->rig.T_left_right.translation_m - Eigen::Vector3d(0.096, 0.0, 0.072)).norm(),
              1e-15);
    EXPECT_LT((file->rig.T_left_right.R() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(RigRos, ProjectionOfTheRightCameraHoldsTheBaseline) {
    camera::StereoRig rig = rig_with(Lens::ideal);
    const auto texts = format_ros_rig(rig);
    ASSERT_TRUE(texts.ok());
    // -350.25 * 0.119978 = -42.0222945
    EXPECT_TRUE(contains(texts->right, "data: [350.25, 0, 330, -42.0222945, 0, 350.25, 190, 0"));
    EXPECT_TRUE(contains(texts->left, "data: [350.25, 0, 330, 0, 0, 350.25, 190, 0, 0, 0, 1, 0]"));
}

TEST(RigRos, BadValuesNameFileAndKey) {
    const std::vector<Bad> table{
        {"camera_matrix", "camera_matrx", "r.yaml:1: key 'camera_matrix' is missing"},
        {"image_width", "image_wide", "key 'image_width' is missing"},
        {"410.", "0.", "r.yaml:4: camera_matrix: focal lengths 0 and 411 must be above 0"},
        {"410.", ".nan", "camera_matrix: nan is outside"},
        {"410., ", "", "camera_matrix: found 8 numbers; at least 9"},
        {"410.", "'410,5'", "'410,5' is not a number"},
        {"plumb_bob", "thin_prism", "'thin_prism' is not one of plumb_bob"},
        {"-0.002, 0.]", "-0.002, 0., 7e-3]", "6 numbers; plumb_bob has 4 or 5"},
        {"distortion_model: plumb_bob\n",
         "distortion_model: ''\n",
         "the coefficients are not 0, but distortion_model is"},
        {"plumb_bob", "rational_polynomial", "5 numbers; rational_polynomial has 8"},
        {"[0.8, 0., 0.6", "[0.8, 0., 0.7", "rectification_matrix: not a rigid motion"},
        {"[400., 0., 322.", "[0., 0., 322.", "projection_matrix: focal lengths 0 and 400"},
        {"241., 0.,", "241., -48.,", "cameras on top of each other"},
        {"-48.", "0.", "r.yaml: projection_matrix: element (0, 3)"},
        {"-48.", "48.", "r.yaml: projection_matrix: element (0, 3)"},
        {"image_width: 640", "image_width: 320", "r.yaml: principal point"},
        {"image_height: 480", "image_height: 481", "image sizes differ"}};
    for (const Bad& bad : table) {
        const auto rig =
            parse_ros_rig({ros_text("left", "0."), "l.yaml"},
                          {replaced(ros_text("right", "-48."), bad.from, bad.to), "r.yaml"});
        EXPECT_TRUE(contains(message(rig), bad.says)) << bad.to << ": " << message(rig);
    }
    EXPECT_TRUE(
        contains(message(parse_ros_rig({"", "l.yaml"}, {"", "r.yaml"})), "l.yaml: expected"));
}

TEST(RigRos, ThePartnerStandsBesideIt) {
    EXPECT_EQ(ros_partner("left.yaml"), "right.yaml");
    EXPECT_EQ(ros_partner("/left/my_left_cam.yaml"), "/left/my_right_cam.yaml");
    EXPECT_EQ(ros_partner("/left/cam.yaml"), std::nullopt);
    const testing::TemporaryFolder folder;
    ASSERT_TRUE(write_rig(folder / "rig", rig_with(Lens::radtan5), RigFormat::ros).ok());
    EXPECT_TRUE(read_rig(folder / "rig").ok());
    EXPECT_TRUE(
        contains(message(read_rig(folder / "rig/right.yaml")), "Give the file of the left camera"));
    ASSERT_TRUE(remove_file(folder / "rig/right.yaml").ok());
    EXPECT_TRUE(contains(message(read_rig(folder / "rig")), "rig/right.yaml: cannot read"));
    EXPECT_TRUE(
        contains(message(write_rig(folder / "cam.yaml", rig_with(Lens::radtan5), RigFormat::ros)),
                 "'left'"));
}

/// A first-generation ZED, two of the four resolutions, as Stereolabs ship it.
const std::string kZed =
    "[LEFT_CAM_HD]\nfx=701.88\nfy=701.7\ncx=641.285\ncy=344.1835\nk1=-0.175286\nk2=0.0283094\n"
    "p1=6.68414e-05\np2=-0.000150431\nk3=4.06032e-11\n"
    "[RIGHT_CAM_HD]\nfx=700.965\nfy=701.11\ncx=633.515\ncy=359.3135\nk1=-0.172795\nk2=0.0265223\n"
    "p1=0.000164482\np2=1.02174e-05\nk3=-1.0484e-10\n"
    "[LEFT_CAM_VGA]\nfx=350.94\nfy=350.85\ncx=336.1425\ncy=179.59175\nk1=-0.175286\nk2=0.0283094\n"
    "[RIGHT_CAM_VGA]\nfx=350.4825\nfy=350.555\ncx=332.2575\ncy=187.15675\nk1=-0.172795\n"
    "k2=0.0265223\n"
    "[STEREO]\nBaseline=119.978\nTY=0.5\nTZ=0.25\nCV_HD=0.00623976\nCV_VGA=0.00623976\n"
    "RX_HD=-0.000916611\nRX_VGA=-0.000916611\nRZ_HD=0.000770041\nRZ_VGA=0.000770041\n"
    "[MISC]\nSensor_ID=0\n";

TEST(RigZed, TheRightCameraLiesToTheRight) {
    const auto file = parse_zed_rig(kZed, "SN1.conf", ImageSize{1280, 720});
    ASSERT_TRUE(file.ok()) << message(file);
    const camera::StereoRig& rig = file->rig;
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig.left.model).fx_px, 701.88);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig.right->model).k3, -1.0484e-10);
    // x_right = R x_left + T with T = (-119.978, 0.5, 0.25) mm: the left camera's centre lies
    // there.
    const Eigen::Vector3d left_in_right = rig.T_left_right.inverse().translation_m;
    EXPECT_LT((left_in_right - Eigen::Vector3d(-0.119978, 0.0005, 0.00025)).norm(), 1e-15);
    EXPECT_GT(rig.T_left_right.translation_m.x(), 0.119);
    const Eigen::Vector3d turn = log_so3(rig.T_left_right.inverse().rotation);
    EXPECT_LT((turn - Eigen::Vector3d(-0.000916611, 0.00623976, 0.000770041)).norm(), 1e-15);
    // Depth of a real disparity is positive.
    const auto rectifier = camera::Rectifier::make(rig);
    ASSERT_TRUE(rectifier.ok());
    EXPECT_GT(rectifier->rig().point(600.0, 300.0, 35.0).z(), 2.0);
    ASSERT_EQ(file->notes.size(), 1U);
    EXPECT_EQ(file->notes[0], "unknown sections are left out: [misc]");
}

TEST(RigZed, TheSizePicksTheSection) {
    const auto vga = parse_zed_rig(kZed, "SN1.conf", ImageSize{672, 376});
    ASSERT_TRUE(vga.ok()) << message(vga);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(vga->rig.left.model).fx_px, 350.94);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(vga->rig.left.model).p1, 0.0);
    EXPECT_EQ(vga->rig.left.width, 672);
    EXPECT_EQ(
        message(parse_zed_rig(kZed, "SN1.conf")),
        "SN1.conf: the file has several resolutions: HD (1280x720), VGA (672x376). Use the file "
        "with its images, or select a resolution with 'surefoot rig FILE --resolution WxH --out "
        "rig.yaml'");
    EXPECT_TRUE(
        contains(message(parse_zed_rig(kZed, "SN1.conf", ImageSize{1920, 1080})),
                 "SN1.conf: the file has no section for 1920x1080 px, only HD (1280x720), VGA"));
}

TEST(RigZed, NewFilesKeepTheLensApart) {
    const std::string lens =
        "k1 = 0.72\nk2 = 0.085\np1 = 0.0006\np2 = -0.0004\nk3 = 0.0011\nk4 = 1.04\nk5 = 0.22\n"
        "k6 = 0.012\n";
    const std::string text = kZed + "[LEFT_DISTO]\n" + lens + "[RIGHT_DISTO]\nk1=1\n";
    const auto file = parse_zed_rig(text, "SN1.conf", ImageSize{1280, 720});
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(std::get<camera::PinholeRational>(file->rig.left.model).k6, 0.012);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(file->rig.right->model).k1, -0.172795);
    EXPECT_EQ(file->notes[0],
              "[RIGHT_DISTO] is left out: it has neither all of k1 k2 p1 p2 k3 k4 k5 k6 nor only "
              "k1 k2 k3 k4");
}

TEST(RigZed, NamesInAnyCaseCommentsAndTheOtherSpelling) {
    std::string text = replaced(kZed, "[LEFT_CAM_HD]", "; made by hand\n[ left_cam_hd ]  # left");
    text = replaced(text, "Baseline=119.978", " BASELINE = 119.978 ; mm");
    text = replaced(text, "CV_HD=", "RY_HD=");
    text = replaced(text, "TY=0.5", "TY_HD=0.5\r\nTY=7");
    const auto file = parse_zed_rig("\xef\xbb\xbf" + text, "SN1.conf", ImageSize{1280, 720});
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_NEAR(file->rig.T_left_right.inverse().translation_m.y(), 0.0005, 1e-15);
}

TEST(RigZed, BadValuesNameFileAndKey) {
    const std::vector<Bad> table{
        {"fx=701.88",
         "fx=701,88",
         "z.conf:2: [LEFT_CAM_HD] fx: '701,88' has a comma; numbers of this file need a '.'"},
        {"Baseline=119.978", "Baseline=119,978", "[STEREO] Baseline: '119,978' has a comma"},
        {"fx=701.88", "fx=nan", "[LEFT_CAM_HD] fx: 'nan' is not a finite number"},
        {"fx=701.88", "fx=", "[LEFT_CAM_HD] fx: '' is not a number"},
        {"fx=701.88", "fx=0", "z.conf: [LEFT_CAM_HD] focal lengths 0 and 701.7 must be above 0"},
        {"fx=701.88\n", "", "z.conf: [LEFT_CAM_HD] has no 'fx'"},
        {"k1=-0.175286\n", "", "z.conf: [LEFT_CAM_HD] has no 'k1'"},
        {"[RIGHT_CAM_HD]", "[RIGHT_CAM]", "z.conf: [RIGHT_CAM_HD] has no 'fx'"},
        {"Baseline=119.978", "Baseline=-119.978", "[STEREO] Baseline = -119.978 must be above 0"},
        {"Baseline=119.978",
         "Baseline=0.119978",
         "[STEREO] Baseline = 0.119978, in millimetres: baseline 0.120 mm is "
         "below 1 mm: is it in km"},
        {"RX_HD=-0.000916611", "RY_2K=0", "z.conf: [STEREO] has no 'RX_HD'"},
        {"CV_HD=0.00623976", "CV_HD=3", "z.conf: the cameras are turned"},
        {"[STEREO]", "STEREO", "z.conf:35: 'STEREO' is neither [section] nor key = value"},
        {"fy=701.7", "fx=701.7", "z.conf:3: 'fx=701.7' sets a key that this section already has"},
        {"[RIGHT_CAM_HD]", "[LEFT_CAM_HD]", "'[LEFT_CAM_HD]' appears twice"},
        {"cx=641.285", "cx=1641.285", "z.conf: left camera: principal point"}};
    for (const Bad& bad : table) {
        const std::string said = message(
            parse_zed_rig(replaced(kZed, bad.from, bad.to), "z.conf", ImageSize{1280, 720}));
        EXPECT_TRUE(contains(said, bad.says)) << bad.from << " -> " << bad.to << ": " << said;
    }
    EXPECT_TRUE(contains(message(parse_zed_rig("", "z.conf")), "z.conf: no [LEFT_CAM_x] section"));
    EXPECT_TRUE(contains(message(parse_zed_rig(std::string("\x7f"
                                                           "ELF\0\x01",
                                                           6),
                                               "z.conf")),
                         "z.conf:1: "));
    EXPECT_TRUE(contains(message(parse_zed_rig("fx=1\n", "z.conf")), "before the first [section]"));
    EXPECT_TRUE(contains(message(parse_zed_rig(std::string(2 << 20, ' '), "z.conf")), "at most"));
    camera::StereoRig other = rig_with(Lens::radtan5);
    other.left.width = other.right->width = 640;
    EXPECT_TRUE(contains(message(format_zed_rig(other)),
                         "cannot store a calibration for images of 640x376 px"));
}

/// Decimal commas, as a German locale has them (which may not be installed).
struct Commas final : std::numpunct<char> {
    [[nodiscard]] char do_decimal_point() const override { return ','; }
    [[nodiscard]] char do_thousands_sep() const override { return '.'; }
    [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

TEST(RigZed, NumbersDoNotDependOnTheLocale) {
    const std::locale before = std::locale::global(std::locale(std::locale(), new Commas));
    const auto file = parse_zed_rig(kZed, "SN1.conf", ImageSize{1280, 720});
    camera::StereoRig rig = rig_with(Lens::radtan5);
    for (camera::Camera* camera : {&rig.left, &*rig.right}) {
        std::get<camera::PinholeRadTan>(camera->model).fx_px = 1350.25;
    }
    const auto text = format_zed_rig(rig);
    std::locale::global(before);
    ASSERT_TRUE(file.ok()) << message(file);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(file->rig.left.model).fx_px, 701.88);
    ASSERT_TRUE(text.ok());
    EXPECT_TRUE(contains(*text, "fx = 1350.25\n"));
}

TEST(RigFormats, FilesAreToldApartByTheirContent) {
    const testing::TemporaryFolder folder;
    const auto format_of = [&](const std::string& name, const std::string& text) {
        EXPECT_TRUE(write_file(folder / name, text).ok());
        const auto file = read_rig_file(folder / name, ImageSize{1280, 720});
        return file.ok() ? name_of(file->format) : "error: " + file.error().message;
    };
    EXPECT_EQ(format_of("a.txt", kZed), "zed");
    EXPECT_EQ(format_of("SN12.conf", kZed), "zed");
    EXPECT_EQ(format_of("b.yaml", kKalibr), "kalibr");
    EXPECT_TRUE(write_file(folder / "cam_right.yaml", ros_text("r", "-48.")).ok());
    EXPECT_EQ(format_of("cam_left.yaml", ros_text("l", "0.")), "ros");
    EXPECT_EQ(format_of("calib.txt",
                        "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -70 0 700 180 0 0 0 1 "
                        "0\n"),
              "kitti");
    EXPECT_EQ(format_of("o.yml", *format_opencv_rig(rig_with(Lens::radtan5))), "opencv");
    EXPECT_EQ(format_of("rig.yaml", format_rig_yaml(rig_with(Lens::rational))), "surefoot");
}

TEST(RigFormats, SurviveDamagedFiles) {
    const auto sound = [](const Result<RigFile>& file) {
        if (file.ok()) {
            EXPECT_FALSE(file->rig.problem().has_value());
        } else {
            EXPECT_FALSE(file.error().message.empty());
        }
    };
    testing::for_each_mutation(kKalibr, 1000, 1, [&](const std::string& text) {
        sound(parse_kalibr_rig(text, "damaged"));
    });
    testing::for_each_mutation(kZed, 2000, 2, [&](const std::string& text) {
        sound(parse_zed_rig(text, "damaged", ImageSize{1280, 720}));
    });
    const NamedText left{ros_text("left", "0."), "left"};
    testing::for_each_mutation(ros_text("right", "-48."), 1000, 3, [&](const std::string& text) {
        sound(parse_ros_rig(left, {text, "damaged"}));
    });
}

}  // namespace
}  // namespace surefoot::io
