// SPDX-License-Identifier: Apache-2.0
// Calibration files of KITTI as users have them.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

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
                 "S_rect_00: found 1 numbers; exactly 2"));
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

}  // namespace
}  // namespace surefoot::io::testing
