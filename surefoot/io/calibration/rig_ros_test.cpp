// SPDX-License-Identifier: Apache-2.0
// Calibration files of ROS as users have them: the values that are read, and the messages.
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

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
    EXPECT_TRUE(contains(message(with("equidistant", kD)), "5 numbers; equidistant has 4"));
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

}  // namespace
}  // namespace surefoot::io::testing
