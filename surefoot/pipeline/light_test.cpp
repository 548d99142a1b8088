// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/light.hpp"

#include <gtest/gtest.h>

namespace surefoot::pipeline {
namespace {

/// `share` of the rows, in blocks, have the grey value `dn`, the others are mid-grey.
GreyImage striped(double share, std::uint8_t dn) {
    GreyImage image(160, 120, 128);
    const int rows = static_cast<int>(share * image.height());
    for (int v = 0; v < rows; ++v) std::fill_n(image.row(v), image.width(), dn);
    return image;
}

StereoFrame frame_of(const GreyImage& left, const GreyImage& right) {
    StereoFrame frame;
    frame.left = left;
    frame.right = right;
    return frame;
}

TEST(Light, APatchOfSunIsNotAnOverexposedImage) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(light_of(frame_of(grey, grey)), Light::lit);
    EXPECT_EQ(light_of(frame_of(striped(0.2, 255), striped(0.2, 255))), Light::lit);
    EXPECT_EQ(light_of(frame_of(striped(0.3, 255), grey)), Light::overexposed);
    EXPECT_EQ(light_of(frame_of(striped(1.0, 249), grey)), Light::lit) << "bright, not clipped";
    EXPECT_EQ(light_of(frame_of(striped(1.0, 250), grey)), Light::overexposed);
}

TEST(Light, ADarkRoomWithALampIsDark) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(light_of(frame_of(striped(0.7, 3), striped(0.7, 3))), Light::lit);
    EXPECT_EQ(light_of(frame_of(striped(0.8, 3), grey)), Light::dark);
    EXPECT_EQ(light_of(frame_of(striped(1.0, 11), grey)), Light::lit);
}

TEST(Light, TheWorseEyeDecides) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(light_of(frame_of(grey, striped(1.0, 0))), Light::dark) << "covered right lens";
    EXPECT_EQ(light_of(frame_of(grey, striped(1.0, 255))), Light::overexposed);
}

TEST(Light, FramesWithoutImagesAreLit) {
    EXPECT_EQ(light_of(StereoFrame{}), Light::lit);
    EXPECT_EQ(light_of(frame_of(striped(0.0, 0), {})), Light::lit) << "RGB-D has one eye";
}

}  // namespace
}  // namespace surefoot::pipeline
