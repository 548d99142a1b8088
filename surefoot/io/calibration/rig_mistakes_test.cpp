// SPDX-License-Identifier: Apache-2.0
// Files that are no calibration, lack a value or are damaged, and the messages about them.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

TEST(RigVariants, AFocalLengthInMillimetresIsSaid) {
    const auto file = parse_rig_file(
        "resolution: [640, 480]\nbaseline_m: 0.12\nfocal_px: 4.2\nprincipal_px: [320, 240]\n",
        "rig.yaml");
    EXPECT_TRUE(file.ok()) << message(file);
    EXPECT_TRUE(
        has_note(file, "focal length 4.20 px is too short for an image of 640 px: is it in mm?"));
}

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
}  // namespace surefoot::io::testing
