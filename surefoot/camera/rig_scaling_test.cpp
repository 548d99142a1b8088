// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rig_scaling.hpp"

#include <gtest/gtest.h>

#include <array>

#include "surefoot/camera/rigs_testing.hpp"

namespace surefoot::camera {
namespace {

/// Rounding of ten operations on coordinates below 4096 px.
constexpr double kRounding_px = 1e-11;

/// Position in the scaled image of the scene point at `pixel` of the full image. Areas scale, and
/// the first pixel extends from -0.5 to 0.5. 104 3 / 2: on a ZED this is another crop
Eigen::Vector2d moved(const Eigen::Vector2d& pixel, double s) {
    const Eigen::Vector2d half(0.5, 0.5);
    return s * (pixel + half) - half;
}

std::string message(const Result<StereoRig>& rig) {
    return rig.ok() ? "accepted" : rig.error().message;
}

TEST(RigScaling, EveryPointMovesAsTheImageIsResized) {
    struct Target {
        StereoRig rig;
        int width, height;
    };
    const std::array<Target, 5> targets{{{test::euroc_rig(), 376, 240},
                                         {test::euroc_rig(), 1504, 960},
                                         {test::euroc_rig(), 564, 360},
                                         {test::fisheye_rig(), 480, 300},
                                         {test::zed_rig(), 336, 188}}};
    for (const Target& target : targets) {
        const auto scaled = scaled_to(target.rig, target.width, target.height);
        ASSERT_TRUE(scaled.ok()) << message(scaled);
        const double s = static_cast<double>(target.width) / target.rig.left.width;
        for (double x = -0.6; x < 0.7; x += 0.15) {
            const Eigen::Vector3d p(x, 0.3 * x - 0.1, 1.0);
            for (const bool right : {false, true}) {
                const auto before =
                    project(right ? target.rig.right->model : target.rig.left.model, p);
                const auto after = project(right ? scaled->right->model : scaled->left.model, p);
                ASSERT_TRUE(before && after);
                EXPECT_LT((*after - moved(*before, s)).norm(), kRounding_px)
                    << target.rig.name << " " << p.transpose();
            }
        }
        EXPECT_EQ(scaled->left.width, target.width);
        EXPECT_EQ(scaled->right->height, target.height);
        EXPECT_EQ(scaled->T_left_right.matrix(), target.rig.T_left_right.matrix());
        EXPECT_EQ(scaled->rectified, target.rig.rectified);
    }
}

/// A size that is no multiple loses the last columns and rows, and the first pixel stays the first.
TEST(RigScaling, ShrinkingKeepsEveryPointInPlace) {
    for (const int factor : {1, 2, 3, 5}) {
        const StereoRig rig = test::euroc_rig();  // 752 x 480
        const StereoRig small = shrunk(rig, factor);
        EXPECT_EQ(small.left.width, 752 / factor);
        EXPECT_EQ(small.right->height, 480 / factor);
        EXPECT_FALSE(small.problem());
        for (double x = -0.6; x < 0.7; x += 0.15) {
            const Eigen::Vector3d p(x, 0.3 * x - 0.1, 1.0);
            const auto before = project(rig.left.model, p);
            const auto after = project(small.left.model, p);
            ASSERT_TRUE(before && after);
            EXPECT_LT((*after - moved(*before, 1.0 / factor)).norm(), kRounding_px) << factor;
        }
    }
}

TEST(RigScaling, ShrunkPixelsAreMeansOfSquares) {
    GreyImage image(11, 8);
    for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint8_t>(i * 37 % 256);
    for (const int factor : {1, 2, 3, 4, 8}) {
        GreyImage small;
        shrink(image.view(), factor, small);
        ASSERT_EQ(small.width(), 11 / factor);
        ASSERT_EQ(small.height(), 8 / factor);
        for (int v = 0; v < small.height(); ++v) {
            for (int u = 0; u < small.width(); ++u) {
                double sum = 0.0;
                for (int y = 0; y < factor; ++y)
                    for (int x = 0; x < factor; ++x)
                        sum += image.at(u * factor + x, v * factor + y);
                EXPECT_NEAR(small.at(u, v), sum / (factor * factor), 0.5) << factor;
            }
        }
    }
}

TEST(RigScaling, TheMiddleOfTheImageStaysTheMiddle) {
    StereoRig rig = test::zed_rig();
    for (Camera* camera : {&rig.left, &*rig.right}) {
        auto& lens = std::get<PinholeRadTan>(camera->model);
        lens.cx_px = 335.5;  // the image is 672 px wide: pixels 0 .. 671
        lens.cy_px = 187.5;
    }
    const auto half = scaled_to(rig, 336, 188);
    ASSERT_TRUE(half.ok()) << message(half);
    EXPECT_EQ(std::get<PinholeRadTan>(half->left.model).cx_px, 167.5);
    EXPECT_EQ(std::get<PinholeRadTan>(half->left.model).cy_px, 93.5);
    EXPECT_EQ(std::get<PinholeRadTan>(half->left.model).fx_px, 171.0);
}

TEST(RigScaling, ThereAndBackIsTheSameRig) {
    const StereoRig rig = test::euroc_rig();
    const auto there = scaled_to(rig, 376, 240);
    ASSERT_TRUE(there.ok());
    const auto back = scaled_to(*there, 752, 480);
    ASSERT_TRUE(back.ok());
    const Eigen::Vector3d p(0.4, -0.2, 1.0);
    EXPECT_LT((*project(back->left.model, p) - *project(rig.left.model, p)).norm(), kRounding_px);
}

TEST(RigScaling, OtherShapesAreRefusedInWords) {
    const StereoRig rig = test::euroc_rig();
    EXPECT_EQ(message(scaled_to(rig, 640, 480)),
              "a calibration for 752 x 480 px cannot be scaled to 640 x 480 px: the width changes "
              "by the factor 0.8511, the height by 1.0000; calibrate at the new resolution");
    EXPECT_NE(message(scaled_to(rig, 375, 240)), "accepted");  // half, but rounded down
    EXPECT_NE(message(scaled_to(rig, 0, 0)), "accepted");
    EXPECT_NE(message(scaled_to(rig, -752, -480)), "accepted");
    EXPECT_NE(message(scaled_to(rig, 752 * 30, 480 * 30)), "accepted");  // larger than any camera
    StereoRig broken = rig;
    broken.right->width = 640;
    EXPECT_EQ(
        message(scaled_to(broken, 376, 240)),
        "image sizes differ: left 752x480, right 640x480 px; both cameras need the same size");
}

TEST(RigScaling, BinningIsAWholeNumber) {
    const Camera hd{PinholeRadTan{}, 1280, 720};
    EXPECT_TRUE(is_binning(hd, 1280, 720));
    EXPECT_TRUE(is_binning(hd, 640, 360));
    EXPECT_TRUE(is_binning(hd, 3840, 2160));
    EXPECT_FALSE(is_binning(hd, 1920, 1080));  // 3 / 2: of a ZED this is another cut-out
    EXPECT_FALSE(is_binning(hd, 640, 480));
    EXPECT_FALSE(is_binning(hd, 0, 0));
}

}  // namespace
}  // namespace surefoot::camera
