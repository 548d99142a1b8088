// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/rigs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/angles.hpp"

namespace surefoot::sim {
namespace {

const camera::PinholeRadTan& lens_of(const camera::StereoRig& rig) {
    return std::get<camera::PinholeRadTan>(rig.left.model);
}

TEST(RigsTest, EveryPresetCanBeUsedAndHasItsOwnName) {
    std::set<std::string> names;
    for (const std::string& name : rig_presets()) {
        const camera::StereoRig rig = rig_preset(name).value();
        EXPECT_EQ(rig.name, name);
        EXPECT_FALSE(rig.problem()) << name << ": " << *rig.problem();
        EXPECT_TRUE(camera::Rectifier::make(rig).ok()) << name;
        names.insert(rig.name);
    }
    EXPECT_EQ(names.size(), rig_presets().size());
}

/// A pixel of the small mode is 4x4 sensor pixels, of HD720 2x2, of the other modes one: the same
/// point has the same angle to the optical axis in all modes.
TEST(RigsTest, ModesOfTheZedSeeWithOneLens) {
    const double full_px = lens_of(rig_preset("zed_hd2k").value()).fx_px;
    EXPECT_EQ(lens_of(rig_preset("zed_hd1080").value()).fx_px, full_px);
    EXPECT_EQ(lens_of(rig_preset("zed_hd720").value()).fx_px, full_px / 2.0);
    EXPECT_EQ(lens_of(rig_preset("zed_vga").value()).fx_px, full_px / 4.0);
    // Focal length and baseline of the thesis: 41.03 px m, within the spread between cameras.
    EXPECT_NEAR(lens_of(rig_preset("zed_vga").value()).fx_px * 0.12, 41.03, 0.02);
}

TEST(RigsTest, ModesHaveTheSizesOfTheDataSheet) {
    const struct {
        const char* name;
        int width;
        int height;
    } sizes[] = {{"zed_vga", 672, 376},
                 {"zed_hd720", 1280, 720},
                 {"zed_hd1080", 1920, 1080},
                 {"zed_hd2k", 2208, 1242},
                 {"duo_mlx", 752, 480}};
    for (const auto& size : sizes) {
        const camera::StereoRig rig = rig_preset(size.name).value();
        EXPECT_EQ(rig.left.width, size.width) << size.name;
        EXPECT_EQ(rig.left.height, size.height) << size.name;
        EXPECT_EQ(rig.readout_s, 0.0) << size.name;
    }
}

TEST(RigsTest, RollingModesDifferInTheReadOutOnly) {
    const camera::StereoRig ideal = rig_preset("zed_vga").value();
    const camera::StereoRig rolling = rig_preset("zed_vga_rolling").value();
    EXPECT_EQ(rolling.readout_s, 0.010);
    EXPECT_EQ(rig_preset("zed_hd2k_rolling").value().readout_s, 1.0 / 15.0);
    EXPECT_EQ(lens_of(rolling).fx_px, lens_of(ideal).fx_px);
    EXPECT_TRUE(rolling.rectified);
}

TEST(RigsTest, DuoSees170DegreesFromCornerToCorner) {
    const camera::StereoRig rig = rig_preset("duo_mlx").value();
    EXPECT_FALSE(rig.rectified);
    EXPECT_EQ(rig.T_left_right.translation_m.x(), 0.030);
    EXPECT_EQ(rig.imu->rate_hz, 100.0);
    const auto first = camera::unproject(rig.left.model, {0.0, 0.0});
    const auto last = camera::unproject(rig.left.model, {751.0, 479.0});
    ASSERT_TRUE(first && last);
    const double between_deg = std::acos(first->dot(*last)) * kDegPerRad;
    // Pixel centres: half a pixel (0.1 deg) inside the corners on either side.
    EXPECT_GT(between_deg, 169.5);
    EXPECT_LT(between_deg, 170.0);
}

}  // namespace
}  // namespace surefoot::sim
