// SPDX-License-Identifier: Apache-2.0
// Checks the centre of gravity of a disc's image against sums over the whole disc.
#include "surefoot/calibration/boards/disc_image.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::calibration {
namespace {

camera::CameraModel pinhole() {
    return camera::PinholeRadTan{.fx_px = 540.0,
                                 .fy_px = 538.0,
                                 .cx_px = 325.0,
                                 .cy_px = 236.0,
                                 .k1 = -0.28,
                                 .k2 = 0.08,
                                 .p1 = 2e-4,
                                 .p2 = -1e-4};
}

camera::CameraModel fisheye() {
    return camera::KannalaBrandt{.fx_px = 300.0,
                                 .fy_px = 300.0,
                                 .cx_px = 395.0,
                                 .cy_px = 305.0,
                                 .k1 = 0.0121,
                                 .k2 = 0.0056,
                                 .k3 = -0.0061,
                                 .k4 = 0.0005};
}

/// Maps positions on a disc of radius 1 into the image.
struct SeenDisc {
    camera::CameraModel model;
    Pose T_camera_disc;
    double radius_m = 0.0;

    [[nodiscard]] Eigen::Vector2d at(double x, double y) const {
        return camera::project(model,
                               T_camera_disc * Eigen::Vector3d(radius_m * x, radius_m * y, 0.0))
            .value();
    }
    bool operator()(double x, double y, double* pixel) const {
        const Eigen::Vector2d seen = at(x, y);
        pixel[0] = seen.x();
        pixel[1] = seen.y();
        return true;
    }
};

/// Weights every part of the disc by the area of its image. The midpoint rule in rings and sectors
/// has an error of second order in their size: 1e-4 of the offset of half a pixel.
Eigen::Vector2d by_sums(const SeenDisc& disc) {
    constexpr int kRings = 60;
    constexpr int kSectors = 90;
    constexpr double kStep = 1e-4;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double area = 0.0;
    for (int ring = 0; ring < kRings; ++ring) {
        for (int sector = 0; sector < kSectors; ++sector) {
            const double r = (ring + 0.5) / kRings;
            const double angle_rad = 2.0 * std::numbers::pi * sector / kSectors;
            const double x = r * std::cos(angle_rad);
            const double y = r * std::sin(angle_rad);
            Eigen::Matrix2d J;
            J.col(0) = (disc.at(x + kStep, y) - disc.at(x - kStep, y)) / (2.0 * kStep);
            J.col(1) = (disc.at(x, y + kStep) - disc.at(x, y - kStep)) / (2.0 * kStep);
            const double part = r * std::abs(J.determinant());
            sum += part * disc.at(x, y);
            area += part;
        }
    }
    return sum / area;
}

constexpr double kSumError_px = 2e-4;

/// Discs far and near, facing the camera and tilted by up to 70 deg.
TEST(DiscImage, IsTheCentreOfGravityOfItsImage) {
    double largest_offset_px = 0.0;
    for (const camera::CameraModel& model : {pinhole(), fisheye()}) {
        for (const double out : {0.0, 0.15, 0.35}) {
            for (const double tilt_rad : {-1.2, -0.5, 0.0, 0.7}) {
                const SeenDisc disc{
                    model,
                    {exp_so3({0.3 * tilt_rad, tilt_rad, 0.2}), {out, -0.6 * out, 0.5}},
                    0.02};
                Eigen::Vector2d found;
                ASSERT_TRUE(disc_image<double>(disc, found.data()));
                const Eigen::Vector2d truth = by_sums(disc);
                EXPECT_LT((found - truth).norm(), kSumError_px)
                    << out << " m from the axis, " << tilt_rad << " rad";
                largest_offset_px = std::max(largest_offset_px, (truth - disc.at(0.0, 0.0)).norm());
            }
        }
    }
    EXPECT_GT(largest_offset_px, 0.2) << "or the cases show nothing";
}

TEST(DiscImage, OfAnAffineMapIsTheImageOfItsCentre) {
    const auto affine = [](double x, double y, double* pixel) {
        pixel[0] = 100.0 + 7.0 * x - 2.0 * y;
        pixel[1] = 50.0 + 1.0 * x + 4.0 * y;
        return true;
    };
    Eigen::Vector2d found;
    ASSERT_TRUE(disc_image<double>(affine, found.data()));
    constexpr double kRounding_px = 1e-12;
    EXPECT_LT((found - Eigen::Vector2d(100.0, 50.0)).norm(), kRounding_px);
}

TEST(DiscImage, EdgeOnOrOutOfSightHasNone) {
    const auto line = [](double x, double, double* pixel) {
        pixel[0] = x;
        pixel[1] = 0.0;
        return true;
    };
    const auto hidden = [](double x, double y, double* pixel) {
        pixel[0] = x;
        pixel[1] = y;
        return x < 0.5;
    };
    Eigen::Vector2d found;
    EXPECT_FALSE(disc_image<double>(line, found.data()));
    EXPECT_FALSE(disc_image<double>(hidden, found.data()));
}

}  // namespace
}  // namespace surefoot::calibration
