// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/rgbd_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::pipeline {
namespace {

camera::Rectifier kinect_rectifier() {
    camera::StereoRig rig;
    rig.left = {camera::PinholeRadTan{525.0, 525.0, 31.5, 23.5}, 64, 48};
    auto rectifier = camera::Rectifier::make(rig);
    EXPECT_TRUE(rectifier.ok()) << rectifier.error().message;
    return std::move(rectifier).value();
}

TEST(RgbdDepth, GivesBackTheMeasuredDepthWithTheKinectsSigma) {
    const camera::Rectifier rectifier = kinect_rectifier();
    Image<float> depth_m(64, 48, 2.0F);
    depth_m.at(10, 20) = 1.0F;
    depth_m.at(11, 20) = kNanF;
    depth_m.at(12, 20) = 0.0F;
    DepthImage out;
    depth_from_rgbd(rectifier, {}, depth_m, out);

    const double fb_px_m = rectifier.rig().depth_to_disparity_px_m();
    EXPECT_NEAR(fb_px_m / double{out.disparity_px.at(0, 0)}, 2.0, 1e-6);
    EXPECT_NEAR(fb_px_m / double{out.disparity_px.at(10, 20)}, 1.0, 1e-6);
    // Nguyen 2012: sigma_z = 0.0012 + 0.0019 (z - 0.4)^2 m; sigma_d = d sigma_z / z.
    const double sigma_z_m = 0.0012 + 0.0019 * 1.6 * 1.6;
    EXPECT_NEAR(double{out.sigma_px.at(0, 0) / out.disparity_px.at(0, 0)}, sigma_z_m / 2.0, 1e-6);
    for (const int u : {11, 12}) {
        EXPECT_TRUE(std::isnan(out.disparity_px.at(u, 20))) << "unknown stays unknown";
        EXPECT_TRUE(std::isnan(out.sigma_px.at(u, 20)));
        EXPECT_EQ(out.outlier_probability.at(u, 20), 1.0F);
    }
}

}  // namespace
}  // namespace surefoot::pipeline
