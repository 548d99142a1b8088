// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/board_renderer.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/executors_testing.hpp"

namespace surefoot::sim {
namespace {

constexpr double kPaper_dn = 200.0;
constexpr double kInk_dn = 40.0;

camera::Camera pinhole() {
    return {camera::PinholeRadTan{.fx_px = 100.0, .fy_px = 100.0, .cx_px = 49.5, .cy_px = 39.5},
            100,
            80};
}

camera::Camera fisheye() {
    return {camera::KannalaBrandt{
                .fx_px = 60.0, .fy_px = 60.0, .cx_px = 49.5, .cy_px = 39.5, .k1 = 0.02},
            100,
            80};
}

PrintedSheet one_disc(double radius_m) {
    PrintedSheet sheet;
    sheet.paper = {-10.0, -10.0, 10.0, 10.0};
    sheet.discs = {{0.0, 0.0, radius_m}};
    return sheet;
}

ImagingConditions two_colours() {
    ImagingConditions look;
    look.paper_dn = kPaper_dn;
    look.ink_dn = kInk_dn;
    return look;
}

Pose straight_ahead(double distance_m) {
    return {Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m}};
}

/// Sum over the image of how black it is, 0..1 per pixel.
double ink_px2(const GreyImage& image) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i)
        sum += (kPaper_dn - image.data()[i]) / (kPaper_dn - kInk_dn);
    return sum;
}

TEST(BoardRenderer, AnEdgeSharesItsPixelsByArea) {
    PrintedSheet sheet;
    sheet.paper = {-10.0, -10.0, 10.0, 10.0};
    // At 1 m a pixel is 1 cm: u = 100 x + 49.5, and pixel 60 covers x of 0.100 .. 0.110 m.
    sheet.rectangles = {{0.0, -10.0, 0.1025, 10.0}};
    Serial serial;
    const GreyImage image =
        render_board(sheet, pinhole(), straight_ahead(1.0), two_colours(), 1, serial);
    for (int v = 0; v < image.height(); ++v) {
        EXPECT_EQ(image.at(49, v), kPaper_dn);
        EXPECT_EQ(image.at(50, v), kInk_dn);
        EXPECT_EQ(image.at(59, v), kInk_dn);
        EXPECT_NEAR(image.at(60, v), 0.25 * kInk_dn + 0.75 * kPaper_dn, 1.0);
        EXPECT_EQ(image.at(61, v), kPaper_dn);
    }
}

TEST(BoardRenderer, ADiscHasItsAreaAndItsCentre) {
    constexpr double kRadius_m = 0.1234;  // at 1 m: 100 px per metre
    Serial serial;
    const GreyImage image =
        render_board(one_disc(kRadius_m), pinhole(), straight_ahead(1.0), two_colours(), 1, serial);
    const double radius_px = 100.0 * kRadius_m;
    EXPECT_NEAR(ink_px2(image), M_PI * radius_px * radius_px, 1.0);
    for (int v = 0; v < 40; ++v) {
        for (int u = 0; u < 50; ++u) EXPECT_NEAR(image.at(u, v), image.at(99 - u, 79 - v), 1.0);
    }
}

TEST(BoardRenderer, EveryLensShowsWhatItProjects) {
    for (const camera::Camera& camera : {pinhole(), fisheye()}) {
        PrintedSheet sheet = one_disc(0.02);
        sheet.discs[0].x_m = 0.2;
        sheet.discs[0].y_m = -0.15;
        const Pose T_camera_sheet{exp_so3({0.3, -0.2, 0.1}), {0.05, 0.02, 0.8}};
        Serial serial;
        const GreyImage image =
            render_board(sheet, camera, T_camera_sheet, two_colours(), 1, serial);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int v = 0; v < image.height(); ++v) {
            for (int u = 0; u < image.width(); ++u)
                sum += (kPaper_dn - image.at(u, v)) * Eigen::Vector3d(u, v, 1.0);
        }
        const Eigen::Vector2d seen = sum.head<2>() / sum.z();
        const Eigen::Vector2d truth =
            *camera::project(camera.model, T_camera_sheet * Eigen::Vector3d(0.2, -0.15, 0.0));
        // The centre of gravity of a tilted disc is beside the image of its centre: < 0.05 px here.
        EXPECT_LT((seen - truth).norm(), 0.08);
    }
}

TEST(BoardRenderer, BehindTheCameraAndBesideThePaperIsBackground) {
    Serial serial;
    ImagingConditions look = two_colours();
    look.background_dn = 77.0;
    const GreyImage behind =
        render_board(one_disc(0.1), pinhole(), straight_ahead(-1.0), look, 1, serial);
    EXPECT_EQ(behind, GreyImage(100, 80, 77));
    PrintedSheet small = one_disc(0.01);
    small.paper = {-0.1, -0.1, 0.1, 0.1};
    const GreyImage beside = render_board(small, pinhole(), straight_ahead(1.0), look, 1, serial);
    EXPECT_EQ(beside.at(0, 0), 77);
    EXPECT_EQ(beside.at(42, 32), kPaper_dn);
}

TEST(BoardRenderer, BlurKeepsTheLightAndNoiseHasItsSize) {
    Serial serial;
    ImagingConditions look = two_colours();
    const GreyImage sharp =
        render_board(one_disc(0.1), pinhole(), straight_ahead(1.0), look, 1, serial);
    look.blur_sigma_px = 1.5;
    const GreyImage blurred =
        render_board(one_disc(0.1), pinhole(), straight_ahead(1.0), look, 1, serial);
    EXPECT_NEAR(ink_px2(blurred), ink_px2(sharp), 1.0);
    EXPECT_GT(blurred.at(60, 40), sharp.at(59, 40));

    look.blur_sigma_px = 0.0;
    look.noise_dn = 4.0;
    const GreyImage noisy =
        render_board(one_disc(0.1), pinhole(), straight_ahead(1.0), look, 1, serial);
    double sum_sq = 0.0;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
        const double difference = static_cast<double>(noisy.data()[i]) - sharp.data()[i];
        sum_sq += difference * difference;
    }
    EXPECT_NEAR(std::sqrt(sum_sq / static_cast<double>(noisy.size())), 4.0, 0.15);
}

TEST(BoardRenderer, SameSeedSameBytesForEveryExecutor) {
    ImagingConditions look = two_colours();
    look.noise_dn = 2.0;
    look.blur_sigma_px = 0.7;
    const Pose T_camera_sheet{exp_so3({0.3, -0.2, 0.1}), {0.0, 0.0, 1.0}};
    Serial serial;
    Threads threads(2);
    const GreyImage one = render_board(one_disc(0.1), fisheye(), T_camera_sheet, look, 7, serial);
    EXPECT_EQ(one, render_board(one_disc(0.1), fisheye(), T_camera_sheet, look, 7, threads));
    EXPECT_NE(one, render_board(one_disc(0.1), fisheye(), T_camera_sheet, look, 8, serial));
}

}  // namespace
}  // namespace surefoot::sim
