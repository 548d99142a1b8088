// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/rig_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;

/// Tolerance: printed doubles read back exactly; only the conversion of a quaternion to a matrix
/// and back rounds.
constexpr double kPoseRounding = 4e-15;

std::string message(const Result<camera::StereoRig>& rig) {
    return rig.ok() ? "accepted" : rig.error().message;
}

template <typename T>
std::string message_of(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

const std::string kShort =
    "layout: side_by_side\nresolution: [672, 376]\nrate_hz: 2.0\nbaseline_m: 0.12\n"
    "focal_px: 350.0\nprincipal_px: [336.0, 188.0]\ndistortion: none\n";

camera::StereoRig random_rig(std::uint64_t seed, bool fisheye) {
    Rng rng(seed);
    camera::StereoRig rig;
    rig.name = "a \"good\" \\ rig: #1";
    const auto lens = [&]() -> camera::CameraModel {
        const double f = rng.uniform(300, 500);
        if (fisheye) return camera::KannalaBrandt{f, f + 1, 320, 240, 0.01, -0.02, 0.003, 1e-4};
        return camera::PinholeRadTan{
            f, f + 1, 320, 240, rng.normal() * 0.1, 0.01, 1e-4, 2e-4, -0.001};
    };
    rig.left = {lens(), 640, 480};
    rig.right = camera::Camera{lens(), 640, 480};
    const auto small = [&] { return 0.01 * rng.normal(); };
    rig.T_left_right = {exp_so3({small(), small(), small()}), {0.12, small(), small()}};
    rig.T_body_left = Pose{exp_so3({rng.normal(), rng.normal(), rng.normal()}), {0.1, 0.2, 1.0}};
    rig.imu = camera::ImuMount{*rig.T_body_left, 400.0};
    rig.rate_hz = 1.0 / 3.0;
    rig.readout_s = 0.011;
    return rig;
}

void expect_same(const camera::StereoRig& a, const camera::StereoRig& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.left.width, b.left.width);
    ASSERT_EQ(a.left.model.index(), b.left.model.index());
    const auto same_lens = [](const camera::CameraModel& m, const camera::CameraModel& n) {
        const Eigen::Vector3d p(0.3, -0.2, 1.0);
        return camera::project(m, p) == camera::project(n, p);
    };
    EXPECT_TRUE(same_lens(a.left.model, b.left.model));
    EXPECT_TRUE(same_lens(a.right->model, b.right->model));
    EXPECT_LT(difference(a.T_left_right, b.T_left_right).norm(), kPoseRounding);
    EXPECT_LT(difference(*a.T_body_left, *b.T_body_left).norm(), kPoseRounding);
    EXPECT_LT(difference(a.imu->T_body_imu, b.imu->T_body_imu).norm(), kPoseRounding);
    EXPECT_EQ(a.imu->rate_hz, b.imu->rate_hz);
    EXPECT_EQ(a.rate_hz, b.rate_hz);
    EXPECT_EQ(a.readout_s, b.readout_s);
    EXPECT_EQ(a.rectified, b.rectified);
}

TEST(RigYaml, ShortFormIsARectifiedPair) {
    const auto rig = parse_rig_yaml(kShort, "rig.yaml");
    ASSERT_TRUE(rig.ok()) << message(rig);
    EXPECT_TRUE(rig->rectified);
    EXPECT_EQ(rig->left.width, 672);
    EXPECT_EQ(rig->T_left_right.translation_m, Eigen::Vector3d(0.12, 0, 0));
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig->right->model).fx_px, 350.0);
    EXPECT_EQ(rig->rate_hz, 2.0);
    EXPECT_FALSE(rig->T_body_left.has_value());
}

TEST(RigYaml, FullFormRoundTrips) {
    for (const bool fisheye : {false, true}) {
        const camera::StereoRig rig = random_rig(5, fisheye);
        const auto copy = parse_rig_yaml(format_rig_yaml(rig), "rig.yaml");
        ASSERT_TRUE(copy.ok()) << message(copy) << "\n" << format_rig_yaml(rig);
        expect_same(rig, *copy);
    }
}

TEST(RigYaml, RgbdRigHasOneCamera) {
    const auto rig = parse_rig_yaml(
        "layout: rgbd\nresolution: [640, 480]\nfocal_px: [525, 526]\nprincipal_px: [319.5, "
        "239.5]\n",
        "rig.yaml");
    ASSERT_TRUE(rig.ok()) << message(rig);
    EXPECT_FALSE(rig->right.has_value());
    const auto copy = parse_rig_yaml(format_rig_yaml(*rig), "rig.yaml");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_FALSE(copy->right.has_value());
}

TEST(RigYaml, BadValuesNameFileLineKeyAndLimit) {
    const auto bad = [](const std::string& from, const std::string& to) {
        return message(parse_rig_yaml(replaced(kShort, from, to), "rig.yaml"));
    };
    EXPECT_EQ(bad("baseline_m", "basline_m"),
              "rig.yaml:4: unknown key 'basline_m'; did you mean 'baseline_m'?");
    EXPECT_EQ(bad("350.0", ".nan"), "rig.yaml:5: focal_px: nan is outside 0 .. 1000000");
    EXPECT_EQ(bad("350.0", "0"), "rig.yaml:5: focal_px: focal length 0 must be above 0 px");
    EXPECT_TRUE(contains(bad("350.0", "-3"), "rig.yaml:5: focal_px: -3 is outside"));
    EXPECT_TRUE(contains(bad("350.0", "inf"), "focal_px: inf is outside"));
    EXPECT_TRUE(contains(bad("0.12", "'0,12'"), "rig.yaml:4: baseline_m: '0,12' is not a number"));
    EXPECT_TRUE(contains(bad("0.12", "0"), "rig.yaml:4: baseline_m: baseline 0.000 mm is below"));
    EXPECT_TRUE(
        contains(bad("0.12", "120"), "baseline_m: baseline 120.000 m exceeds 5 m: is it in mm"));
    EXPECT_EQ(bad("[336.0, 188.0]", "[336.0]"),
              "rig.yaml:6: principal_px: found 1 numbers; exactly 2 are needed");
    EXPECT_TRUE(
        contains(bad("baseline_m: 0.12\n", ""), "baseline_m: this key is missing; a camera"));
    EXPECT_TRUE(
        contains(bad("[672, 376]", "[672, 0]"), "rig.yaml:2: resolution: 0 is not an image side"));
    EXPECT_TRUE(contains(bad("side_by_side", "stacked"), "is not one of side_by_side"));
    EXPECT_TRUE(contains(bad("none", "radtan"), "must be 'none' here"));
    EXPECT_TRUE(contains(message(parse_rig_yaml("", "rig.yaml")), "but this one has nothing"));
    const std::string full = format_rig_yaml(random_rig(6, false));
    const auto bad_full = [&](const std::string& from, const std::string& to) {
        return message(parse_rig_yaml(replaced(full, from, to), "rig.yaml"));
    };
    EXPECT_TRUE(contains(bad_full("model: pinhole", "model: fish"),
                         "not one of pinhole | pinhole_rational | kannala_brandt"));
    EXPECT_TRUE(
        contains(bad_full("coefficients: [", "coefficients: [1, 2, "), "7 numbers; pinhole has 5"));
    EXPECT_TRUE(contains(bad_full("T_left_right: [", "T_left_right: [5"), "not a rigid motion"));
    EXPECT_TRUE(contains(bad_full("  focal_px", "  focal_length_px"),
                         "unknown key 'left.focal_length_px'"));
}

TEST(RigEuroc, RoundTripsAndReadsInlineComments) {
    const camera::StereoRig rig = random_rig(7, true);
    EurocCamera original{rig.left, *rig.T_body_left, 20.0, 0.01};
    const auto copy = parse_euroc_camera(format_euroc_camera(original), "sensor.yaml");
    ASSERT_TRUE(copy.ok()) << message_of(copy);
    EXPECT_LT(difference(copy->T_body_camera, original.T_body_camera).norm(), kPoseRounding);
    EXPECT_EQ(copy->readout_s, 0.01);
    EXPECT_EQ(copy->camera.model.index(), original.camera.model.index());
    const auto imu =
        parse_euroc_imu("%YAML:1.0\n" + format_euroc_imu(*rig.imu) + "# end\n", "imu.yaml");
    ASSERT_TRUE(imu.ok()) << message_of(imu);
    EXPECT_EQ(imu->rate_hz, 400.0);
    const std::string good = format_euroc_camera(original);
    const auto bad = [&](const std::string& from, const std::string& to) {
        return message_of(parse_euroc_camera(replaced(good, from, to), "sensor.yaml"));
    };
    EXPECT_TRUE(contains(bad("T_BS", "T_SB"), "key 'T_BS' is missing"));
    EXPECT_TRUE(
        contains(bad("intrinsics: [", "intrinsics: [nan, "), "sensor.yaml:9: intrinsics: nan"));
    EXPECT_TRUE(contains(bad("intrinsics: [", "intrinsics: [-"), "must be above 0"));
    EXPECT_TRUE(contains(bad("equidistant", "fov"), "is not one of radial-tangential"));
}

TEST(RigEuroc, ReadsTheRealRig) {
    const std::string path = data_path("sequences/euroc_still");
    if (path.empty()) return;
    for (const std::string& folder : {path, path + "/mav0"}) {
        const auto rig = read_rig(folder);
        ASSERT_TRUE(rig.ok()) << message(rig);
        // Burri et al. 2016: baseline of the VI sensor 0.110 m.
        EXPECT_NEAR(rig->T_left_right.translation_m.x(), 0.110, 1e-3);
        EXPECT_EQ(std::get<camera::PinholeRadTan>(rig->left.model).p2, 1.76187114e-05);
        EXPECT_TRUE(rig->imu.has_value());
        EXPECT_FALSE(rig->rectified);
        EXPECT_EQ(rig->rate_hz, 20.0);
    }
    EXPECT_TRUE(contains(message(read_rig(path + "/mav0/cam0/sensor.yaml")),
                         "give the folder that contains cam0"));
}

TEST(RigKitti, BaselineComesFromTheProjection) {
    const std::string path = data_path("sequences/kitti_city/calib.txt");
    if (path.empty()) return;
    EXPECT_TRUE(contains(message(read_rig(path)), "has no image size"));
    const auto rig = read_rig(path, ImageSize{1226, 370});
    ASSERT_TRUE(rig.ok()) << message(rig);
    EXPECT_NEAR(rig->T_left_right.translation_m.x(), 379.8145 / 707.0912, 1e-12);
    EXPECT_TRUE(rig->rectified);
}

TEST(RigKitti, BadLinesAreNamed) {
    const std::string row = " 700 0 600 0 0 700 180 0 0 0 1 0\n";
    const auto bad = [](const std::string& text) {
        const auto calibration = parse_kitti_calibration(text, "calib.txt");
        if (!calibration.ok()) return calibration.error().message;
        return message(kitti_rig(*calibration, 0, 1, {1226, 370}, "calib.txt"));
    };
    EXPECT_TRUE(contains(bad("P0:" + row), "calib.txt: the line 'P1:' is missing"));
    EXPECT_TRUE(contains(bad("P0: 1 2 3\n"), "calib.txt:1: P0: found 3 numbers; exactly 12"));
    EXPECT_TRUE(contains(bad("P0:" + replaced(row, "700", "nan")), "P0: 'nan' is not a finite"));
    EXPECT_TRUE(contains(bad("P0:" + replaced(row, "700", "-700")), "must be above 0 px"));
    EXPECT_TRUE(contains(bad("P0:" + row + "P1:" + row), "calib.txt: baseline 0.0"));
}

const std::string kOpenCv =
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\nM1: !!opencv-matrix\n   rows: 3\n   "
    "cols: 3\n"
    "   dt: d\n   data: [ 5.3e+02, 0., 3.3e+02, 0.,\n       5.4e+02, 2.4e+02, 0., 0., 1. ]\n"
    "D1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ 0.1, -0.2, 0., 0., 0.3 ]\n"
    "M2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 530., 0., 330., 0., 540., "
    "240., 0., "
    "0., 1. ]\nD2: !!opencv-matrix\n   rows: 1\n   cols: 4\n   dt: d\n   data: [ 0., 0., 0., 0. ]\n"
    "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0.8, 0., 0.6, 0., 1., 0., "
    "-0.6, 0., "
    "0.8 ]\nT: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -0.1, 0., 0.01 ]\n";

TEST(RigOpenCv, FollowsTheConventionOfStereoCalibrate) {
    const auto rig = parse_opencv_rig(kOpenCv, "stereo.yml");
    ASSERT_TRUE(rig.ok()) << message(rig);
    Eigen::Matrix3d R;
    R << 0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8;
    const Eigen::Vector3d p_left(0.3, -0.4, 2.0);
    const Eigen::Vector3d p_right = R * p_left + Eigen::Vector3d(-0.1, 0.0, 0.01);
    EXPECT_LT((rig->T_left_right * p_right - p_left).norm(), 1e-14);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig->left.model).k3, 0.3);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig->left.model).fy_px, 540.0);
    EXPECT_EQ(rig->left.width, 640);
    const std::string body = kOpenCv.substr(kOpenCv.find("image_width"));
    const auto fisheye =
        parse_opencv_rig("fisheye: 1\n" + replaced(body, ", 0.3 ]", " ]"), "f.yml");
    ASSERT_TRUE(fisheye.ok()) << message(fisheye);
    EXPECT_TRUE(std::holds_alternative<camera::KannalaBrandt>(fisheye->left.model));
}

TEST(RigOpenCv, WhatIsMissingOrWrongIsNamed) {
    const auto bad = [](const std::string& from, const std::string& to) {
        return message(parse_opencv_rig(replaced(kOpenCv, from, to), "s.yml"));
    };
    EXPECT_TRUE(contains(bad("\nT:", "\nQ:"), "key 'T' is missing"));
    EXPECT_TRUE(
        contains(bad("-0.1, 0., 0.01", "-119.9, 0., 0.01"), "is it in mm (then 119.9 mm)?"));
    EXPECT_TRUE(contains(bad("5.3e+02", ".Nan"), "M1: nan is outside"));
    EXPECT_TRUE(contains(bad("5.3e+02", "-1."), "M1: focal lengths -1 and 540 must be above 0"));
    EXPECT_TRUE(contains(bad("0.8, 0., 0.6, 0.", "0.8, 0., 0.9, 0."), "R: not a rigid motion"));
    EXPECT_TRUE(contains(bad("-0.2, 0., 0., 0.3", "-0.2, 0., 0., 0.3, 0., 0., 0., 0.5"),
                         "coefficient 9 is 0.5"));
    EXPECT_TRUE(contains(bad("image_width: 640\n", ""), "has no image size"));
}

TEST(RigOpenCv, ReadsRealIntrinsicsWithExtrinsicsBeside) {
    const std::string path = data_path("calibration/chess_pinhole/intrinsics.yml");
    if (path.empty()) return;
    EXPECT_TRUE(contains(message(read_rig(path, ImageSize{640, 480})), "key 'R' is missing"));
    const testing::TemporaryFolder folder;
    std::filesystem::copy_file(path, folder / "intrinsics.yml");
    ASSERT_TRUE(write_file(folder / "extrinsics.yml",
                           "%YAML:1.0\n---\n" + kOpenCv.substr(kOpenCv.find("R: !!")))
                    .ok());
    const auto rig = read_rig(folder / "intrinsics.yml", ImageSize{640, 480});
    ASSERT_TRUE(rig.ok()) << message(rig);
    EXPECT_EQ(std::get<camera::PinholeRadTan>(rig->left.model).fx_px, 534.80326845051309);
}

TEST(Rig, ReadsTheRealShortForm) {
    const std::string path = data_path("sequences/zed_office/rig.yaml");
    if (path.empty()) return;
    const auto rig = read_rig(path);
    ASSERT_TRUE(rig.ok()) << message(rig);
    EXPECT_EQ(rig->left.width, 672);
    EXPECT_TRUE(
        contains(message_of(read_rig("/nowhere/rig.yaml")), "/nowhere/rig.yaml: cannot read"));
    EXPECT_FALSE(write_rig_yaml("/dev/full", *rig).ok());
}

TEST(Rig, SurvivesDamagedFiles) {
    const std::string kitti =
        "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -70 0 700 180 0 0 0 1 0\n";
    const EurocCamera euroc{random_rig(8, false).left, Pose{}, 20.0, 0.0};
    const auto sound = [](const Result<camera::StereoRig>& rig) {
        if (rig.ok()) {
            EXPECT_FALSE(rig->problem().has_value());
        }
    };
    testing::for_each_mutation(
        format_rig_yaml(random_rig(9, false)), 2000, 1, [&](const auto& text) {
            sound(parse_rig_yaml(text, "damaged"));
        });
    testing::for_each_mutation(
        kShort, 2000, 2, [&](const auto& text) { sound(parse_rig_yaml(text, "damaged")); });
    testing::for_each_mutation(
        kOpenCv, 2000, 3, [&](const auto& text) { sound(parse_opencv_rig(text, "damaged")); });
    testing::for_each_mutation(kitti, 2000, 4, [&](const auto& text) {
        const auto calibration = parse_kitti_calibration(text, "damaged");
        if (calibration.ok()) sound(kitti_rig(*calibration, 0, 1, {1226, 370}, "damaged"));
    });
    testing::for_each_mutation(format_euroc_camera(euroc), 2000, 5, [](const auto& text) {
        const auto camera = parse_euroc_camera(text, "damaged");
        if (camera.ok()) {
            EXPECT_FALSE(camera->camera.problem().has_value());
        }
    });
}

}  // namespace
}  // namespace surefoot::io
