// SPDX-License-Identifier: Apache-2.0
// Calibration files of Middlebury as users have them.
#include <gtest/gtest.h>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_testing.hpp"
#include "surefoot/io/calibration/rig_texts_testing.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io::testing {
namespace {

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

}  // namespace
}  // namespace surefoot::io::testing
