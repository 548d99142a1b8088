// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/board_view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/sim/sensors/cameras_testing.hpp"

namespace surefoot::sim {
namespace {

TEST(BoardView, TheBoardStandsWhereItWasPut) {
    const camera::StereoRig rig = test::small_rig();
    const camera::RectifiedRig rectified = camera::Rectifier::make(rig).value().rig();
    const int u = static_cast<int>(rectified.cx_px);
    const int v = static_cast<int>(rectified.cy_px);
    Serial serial;
    BoardView view;
    for (const double distance_m : {0.3, 0.8, 2.0}) {
        view.distance_m = distance_m;
        const auto seen = see_board(view, rig, rectified, serial);
        ASSERT_TRUE(seen.ok());
        const auto depth_m = [&](int row) {
            return rectified.depth_to_disparity_px_m() /
                   static_cast<double>(seen->disparity_px.at(u, row));
        };
        EXPECT_NEAR(depth_m(v), distance_m, 1e-6);
        // Half of the board, seen from its middle: just inside and just outside.
        const int edge_px = static_cast<int>(0.5 * view.side_m * rectified.fx_px / distance_m);
        if (edge_px + 2 > v) continue;  // the board fills the image
        EXPECT_NEAR(depth_m(v - edge_px + 2), distance_m, 1e-6);
        EXPECT_NEAR(depth_m(v - edge_px - 2), distance_m + 1.5, 1e-6);
    }
}

TEST(BoardView, TheImagesShowATextureThatTheSeedTurns) {
    const camera::StereoRig rig = test::small_rig();
    const camera::RectifiedRig rectified = camera::Rectifier::make(rig).value().rig();
    Serial serial;
    BoardView view;
    view.camera = test::noiseless();
    const auto one = see_board(view, rig, rectified, serial);
    const auto same = see_board(view, rig, rectified, serial);
    view.seed = 2;
    const auto other = see_board(view, rig, rectified, serial);
    ASSERT_TRUE(one.ok() && same.ok() && other.ok());
    EXPECT_EQ(one->frame.left, same->frame.left);
    EXPECT_FALSE(one->frame.left == other->frame.left);
    // The right camera sees the middle of the board at the position that the disparity gives.
    const int u = static_cast<int>(rectified.cx_px);
    const int v = static_cast<int>(rectified.cy_px);
    const int shift_px = static_cast<int>(std::lround(one->disparity_px.at(u, v)));
    double sum = 0.0;
    double sum_unshifted = 0.0;
    for (int k = -15; k <= 15; ++k) {
        sum += std::abs(one->frame.left.at(u + k, v) - one->frame.right.at(u + k - shift_px, v));
        sum_unshifted += std::abs(one->frame.left.at(u + k, v) - one->frame.right.at(u + k, v));
    }
    EXPECT_LT(sum, 0.6 * sum_unshifted);
}

TEST(BoardView, SaysWhyARigCannotBeUsed) {
    camera::StereoRig rig = test::small_rig();
    const camera::RectifiedRig rectified = camera::Rectifier::make(rig).value().rig();
    rig.right.reset();
    Serial serial;
    EXPECT_FALSE(see_board({}, rig, rectified, serial).ok());
}

}  // namespace
}  // namespace surefoot::sim
