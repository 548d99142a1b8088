// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/exposure_state.hpp"

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

TEST(ExposureState, APatchOfSunIsNotAnOverexposedImage) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(exposure_state_of(frame_of(grey, grey)), ExposureState::well_exposed);
    EXPECT_EQ(exposure_state_of(frame_of(striped(0.2, 255), striped(0.2, 255))),
              ExposureState::well_exposed);
    EXPECT_EQ(exposure_state_of(frame_of(striped(0.3, 255), grey)), ExposureState::overexposed);
    EXPECT_EQ(exposure_state_of(frame_of(striped(1.0, 249), grey)), ExposureState::well_exposed)
        << "bright, not clipped";
    EXPECT_EQ(exposure_state_of(frame_of(striped(1.0, 250), grey)), ExposureState::overexposed);
}

TEST(ExposureState, ADarkRoomWithALampIsDark) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(exposure_state_of(frame_of(striped(0.7, 3), striped(0.7, 3))),
              ExposureState::well_exposed);
    EXPECT_EQ(exposure_state_of(frame_of(striped(0.8, 3), grey)), ExposureState::dark);
    EXPECT_EQ(exposure_state_of(frame_of(striped(1.0, 11), grey)), ExposureState::well_exposed);
}

TEST(ExposureState, TheWorseEyeDecides) {
    const GreyImage grey = striped(0.0, 0);
    EXPECT_EQ(exposure_state_of(frame_of(grey, striped(1.0, 0))), ExposureState::dark)
        << "covered right lens";
    EXPECT_EQ(exposure_state_of(frame_of(grey, striped(1.0, 255))), ExposureState::overexposed);
}

TEST(ExposureState, FramesWithoutImagesAreLit) {
    EXPECT_EQ(exposure_state_of(StereoFrame{}), ExposureState::well_exposed);
    EXPECT_EQ(exposure_state_of(frame_of(striped(0.0, 0), {})), ExposureState::well_exposed)
        << "RGB-D has one camera";
}

}  // namespace
}  // namespace surefoot::pipeline
