// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/camera_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::camera {
namespace {

/// Both directions are solved to 1e-12 in normalised coordinates; multiplied by f < 1000 px.
constexpr double kRoundTrip_px = 1e-8;
constexpr double kRoundTrip_rad = 1e-9;
/// Central differences with h = 1e-6: truncation h^2 and rounding 1e-16 f / h.
constexpr double kStep = 1e-6;
constexpr double kJacobianTolerance = 1e-5;

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();

struct Case {
    const char* name;
    Camera camera;
    bool whole_image;  ///< every pixel has a ray
};

/// One line here adds a new model to the property tests.
std::vector<Case> cases() {
    const Camera folding{
        PinholeRadTan{
            .fx_px = 300, .fy_px = 310, .cx_px = 320, .cy_px = 235, .k1 = -0.45, .k2 = 0.1},
        640,
        480};
    const Camera tangential{PinholeRadTan{.fx_px = 420,
                                          .fy_px = 415,
                                          .cx_px = 310,
                                          .cy_px = 250,
                                          .k1 = 0.08,
                                          .k2 = -0.02,
                                          .p1 = 0.01,
                                          .p2 = -0.008,
                                          .k3 = 0.003},
                            640,
                            480};
    const Camera equidistant{
        KannalaBrandt{.fx_px = 200, .fy_px = 205, .cx_px = 320, .cy_px = 240}, 640, 480};
    // Calibrations with 8 coefficients as for wide lenses: numerator and denominator nearly cancel.
    // The second lens folds back inside its image.
    const Camera rational{PinholeRational{.fx_px = 365,
                                          .fy_px = 366,
                                          .cx_px = 316,
                                          .cy_px = 243,
                                          .k1 = 0.72,
                                          .k2 = 0.085,
                                          .p1 = 0.0006,
                                          .p2 = -0.0004,
                                          .k3 = 0.0011,
                                          .k4 = 1.04,
                                          .k5 = 0.22,
                                          .k6 = 0.012},
                          640,
                          480};
    const Camera rational_folding{
        PinholeRational{
            .fx_px = 400, .fy_px = 405, .cx_px = 320, .cy_px = 235, .k1 = -0.2, .k4 = 0.1},
        640,
        480};
    return {{"zed", test::zed_rig().left, true},
            {"euroc_cam0", test::euroc_rig().left, true},
            {"euroc_cam1", *test::euroc_rig().right, true},
            {"radtan_folding", folding, false},
            {"radtan_tangential", tangential, true},
            {"rational", rational, true},
            {"rational_folding", rational_folding, false},
            {"fisheye_170", test::fisheye_rig().left, false},
            {"fisheye_equidistant", equidistant, true}};
}

class EveryCamera : public testing::TestWithParam<Case> {
  protected:
    const Camera& camera() const { return GetParam().camera; }
    Eigen::Vector2d principal_point() const {
        return std::visit([](const auto& m) { return Eigen::Vector2d(m.cx_px, m.cy_px); },
                          camera().model);
    }
    Eigen::Vector2d focal() const {
        return std::visit([](const auto& m) { return Eigen::Vector2d(m.fx_px, m.fy_px); },
                          camera().model);
    }
    /// Points all around the camera, near and far.
    static std::vector<Eigen::Vector3d> points() {
        std::vector<Eigen::Vector3d> result;
        for (int i = 0; i <= 36; ++i) {
            for (int j = 0; j < 24; ++j) {
                const double theta = i * std::numbers::pi / 36.0;
                const double phi = j * std::numbers::pi / 12.0;
                for (const double distance_m : {0.05, 1.0, 80.0}) {
                    result.emplace_back(distance_m * std::sin(theta) * std::cos(phi),
                                        distance_m * std::sin(theta) * std::sin(phi),
                                        distance_m * std::cos(theta));
                }
            }
        }
        return result;
    }
};

std::string case_name(const testing::TestParamInfo<Case>& info) {
    return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Models, EveryCamera, testing::ValuesIn(cases()), case_name);

TEST_P(EveryCamera, IsUsable) {
    EXPECT_EQ(camera().problem(), std::nullopt);
}

TEST_P(EveryCamera, PixelsReturnAlongTheirRay) {
    int seen = 0;
    int all = 0;
    for (int v = 0; v < camera().height; v += 10) {
        for (int u = 0; u < camera().width; u += 10) {
            ++all;
            const Eigen::Vector2d pixel(u, v);
            const auto ray = unproject(camera().model, pixel);
            if (!ray) continue;
            ++seen;
            EXPECT_NEAR(ray->norm(), 1.0, 1e-14);
            for (const double distance_m : {0.1, 30.0}) {
                const auto back = project(camera().model, distance_m * *ray);
                ASSERT_TRUE(back) << "pixel " << pixel.transpose();
                EXPECT_LT((*back - pixel).norm(), kRoundTrip_px)
                    << "pixel " << pixel.transpose() << " came back at " << back->transpose();
            }
        }
    }
    if (GetParam().whole_image) {
        EXPECT_EQ(seen, all);
    }
    EXPECT_GT(seen, all / 2);
}

TEST_P(EveryCamera, PointsReturnToTheirDirection) {
    int seen = 0;
    for (const Eigen::Vector3d& p : points()) {
        const auto pixel = project(camera().model, p);
        if (!pixel) continue;
        ++seen;
        // Near the fold the slope is almost zero: the inverse is ill-conditioned there.
        Matrix32 d_ray;
        const auto ray = unproject(camera().model, *pixel, &d_ray);
        ASSERT_TRUE(ray) << "point " << p.transpose() << " at " << pixel->transpose();
        const double tolerance_rad =
            kRoundTrip_rad * std::max(1.0, d_ray.norm() * focal().maxCoeff());
        EXPECT_LT((*ray - p.normalized()).norm(), tolerance_rad) << "point " << p.transpose();
    }
    EXPECT_GT(seen, 200);
}

TEST_P(EveryCamera, ProjectionJacobianIsTheNumericOne) {
    Rng rng(11);
    int checked = 0;
    for (int n = 0; n < 400; ++n) {
        const Eigen::Vector3d p(
            rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5), rng.uniform(-0.3, 2.0));
        Matrix23 analytic;
        if (!project(camera().model, p, &analytic)) continue;
        Matrix23 numeric;
        bool complete = true;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
            const auto plus = project(camera().model, p + step);
            const auto minus = project(camera().model, p - step);
            complete = complete && plus && minus;
            if (complete) numeric.col(axis) = (*plus - *minus) / (2.0 * kStep);
        }
        // Near the camera plane the third derivative and with it the truncation error become very
        // large.
        if (!complete || analytic.norm() > 1e5) continue;
        ++checked;
        EXPECT_LT((analytic - numeric).norm(), kJacobianTolerance * (1.0 + analytic.norm()))
            << "point " << p.transpose() << "\nanalytic\n"
            << analytic << "\nnumeric\n"
            << numeric;
    }
    EXPECT_GT(checked, 150);
}

TEST_P(EveryCamera, UnprojectionJacobianIsTheNumericOne) {
    constexpr double kPixelStep = 1e-3;
    int checked = 0;
    for (int v = 3; v < camera().height; v += 37) {
        for (int u = 2; u < camera().width; u += 37) {
            const Eigen::Vector2d pixel(u, v);
            Matrix32 analytic;
            if (!unproject(camera().model, pixel, &analytic)) continue;
            Matrix32 numeric;
            bool complete = true;
            for (int axis = 0; axis < 2; ++axis) {
                const Eigen::Vector2d step = kPixelStep * Eigen::Vector2d::Unit(axis);
                const auto plus = unproject(camera().model, pixel + step);
                const auto minus = unproject(camera().model, pixel - step);
                complete = complete && plus && minus;
                if (complete) numeric.col(axis) = (*plus - *minus) / (2.0 * kPixelStep);
            }
            // Near the fold one pixel covers a large angle.
            if (!complete || analytic.norm() * focal().maxCoeff() > 20.0) continue;
            ++checked;
            EXPECT_LT((analytic - numeric).norm(), kJacobianTolerance * analytic.norm())
                << "pixel " << pixel.transpose() << "\nanalytic\n"
                << analytic << "\nnumeric\n"
                << numeric;
        }
    }
    EXPECT_GT(checked, 80);
}

TEST_P(EveryCamera, AxisMeetsThePrincipalPoint) {
    for (const double z_m : {1e-3, 1.0, 1e4}) {
        Matrix23 J;
        const auto pixel = project(camera().model, {0.0, 0.0, z_m}, &J);
        ASSERT_TRUE(pixel);
        EXPECT_EQ(*pixel, principal_point());
        EXPECT_DOUBLE_EQ(J(0, 0), focal().x() / z_m);
        EXPECT_DOUBLE_EQ(J(1, 1), focal().y() / z_m);
        EXPECT_EQ(J(0, 1), 0.0);
        EXPECT_EQ(J.col(2).norm(), 0.0);
    }
    Matrix32 d_ray;
    const auto ray = unproject(camera().model, principal_point(), &d_ray);
    ASSERT_TRUE(ray);
    EXPECT_EQ(*ray, Eigen::Vector3d::UnitZ());
    EXPECT_DOUBLE_EQ(d_ray(0, 0), 1.0 / focal().x());
    EXPECT_DOUBLE_EQ(d_ray(1, 1), 1.0 / focal().y());
}

TEST_P(EveryCamera, OriginAndTheAxisBehindHaveNoImage) {
    EXPECT_FALSE(project(camera().model, {0.0, 0.0, 0.0}));
    EXPECT_FALSE(project(camera().model, {0.0, 0.0, -1.0}));
    EXPECT_FALSE(project(camera().model, {0.0, 0.0, -1e-9}));
}

TEST_P(EveryCamera, NotANumberHasNoImageAndNoRay) {
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::Vector3d p(0.1, 0.2, 1.0);
            p[axis] = bad;
            EXPECT_FALSE(project(camera().model, p)) << p.transpose();
        }
        for (int axis = 0; axis < 2; ++axis) {
            Eigen::Vector2d pixel = principal_point();
            pixel[axis] = bad;
            EXPECT_FALSE(unproject(camera().model, pixel)) << pixel.transpose();
        }
    }
}

/// With growing distance from the axis the image moves outward; a lost point stays lost.
TEST_P(EveryCamera, NothingBeyondTheLensAppearsInTheImage) {
    for (int j = 0; j < 16; ++j) {
        const double phi = j * std::numbers::pi / 8.0;
        double last_radius_px = -1.0;
        bool lost = false;
        for (int i = 0; i <= 1800; ++i) {
            const double theta = i * std::numbers::pi / 1800.0;
            const Eigen::Vector3d p(
                std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            const auto pixel = project(camera().model, p);
            if (!pixel) {
                lost = true;
                continue;
            }
            ASSERT_FALSE(lost) << "theta " << theta << " phi " << phi << " reappears at "
                               << pixel->transpose();
            const double radius_px = (*pixel - principal_point()).norm();
            ASSERT_GT(radius_px, last_radius_px) << "theta " << theta << " phi " << phi;
            last_radius_px = radius_px;
        }
    }
}

TEST(PinholeRadTan, PointsBehindTheCameraHaveNoImage) {
    const auto model = std::get<PinholeRadTan>(test::euroc_rig().left.model);
    EXPECT_FALSE(model.project({0.1, 0.1, -1.0}));
    EXPECT_FALSE(model.project({0.1, 0.1, 0.0}));
}

TEST(PinholeRadTan, FarOffAxisPointsDoNotAliasIntoTheImage) {
    // r (1 - 0.45 r^2) folds back at r = 0.86: the same pixel would show r = 0.5 and r = 1.17.
    const PinholeRadTan model{.fx_px = 300, .fy_px = 300, .cx_px = 320, .cy_px = 240, .k1 = -0.45};
    EXPECT_TRUE(model.project({0.85, 0.0, 1.0}));
    EXPECT_FALSE(model.project({0.87, 0.0, 1.0}));
    EXPECT_FALSE(model.project({1.17, 0.0, 1.0}));
    // Largest image radius 300 * 0.86 * 2/3 = 172 px: no ray exists beyond it.
    EXPECT_TRUE(model.unproject({320.0 + 171.0, 240.0}));
    EXPECT_FALSE(model.unproject({320.0 + 173.0, 240.0}));
}

TEST(PinholeRational, WithoutDenominatorIsTheRadialTangentialModel) {
    const PinholeRadTan plain = std::get<PinholeRadTan>(test::euroc_rig().left.model);
    const PinholeRational rational{plain.fx_px,
                                   plain.fy_px,
                                   plain.cx_px,
                                   plain.cy_px,
                                   plain.k1,
                                   plain.k2,
                                   plain.p1,
                                   plain.p2,
                                   plain.k3};
    for (double x = -1.2; x < 1.3; x += 0.1) {
        const Eigen::Vector3d p(x, 0.3 - 0.5 * x, 1.0);
        EXPECT_EQ(rational.project(p), plain.project(p)) << p.transpose();
    }
}

TEST(PinholeRadTan, TangentialTermsDoNotTurnTheImageFarOffAxis) {
    // u / f = x + 3 p2 x^2 folds back at x = -1 / (6 p2) = -16.7. Far out det J is positive again.
    const PinholeRadTan model{.fx_px = 300, .fy_px = 300, .cx_px = 320, .cy_px = 240, .p2 = 0.01};
    EXPECT_TRUE(model.project({-16.0, 0.0, 1.0}));
    EXPECT_FALSE(model.project({-17.0, 0.0, 1.0}));
    EXPECT_FALSE(model.project({-100.0, 0.0, 1.0}));
}

TEST(PinholeRational, NothingAppearsBeyondThePoleOfTheDenominator) {
    // The denominator 1 - 0.5 r^2 is 0 at r = 1.414: beyond it points would jump to the other image
    // side.
    const PinholeRational model{.fx_px = 300, .fy_px = 300, .cx_px = 320, .cy_px = 240, .k4 = -0.5};
    EXPECT_TRUE(model.project({1.41, 0.0, 1.0}));
    EXPECT_FALSE(model.project({1.42, 0.0, 1.0}));
    EXPECT_FALSE(model.project({5.0, 0.0, 1.0}));
}

TEST(KannalaBrandt, SeesPointsBehindTheImagePlane) {
    const auto model = std::get<KannalaBrandt>(test::fisheye_rig().left.model);
    const double theta = 100.0 * std::numbers::pi / 180.0;
    const auto pixel = model.project({std::sin(theta), 0.0, std::cos(theta)});
    ASSERT_TRUE(pixel);
    const auto ray = model.unproject(*pixel);
    ASSERT_TRUE(ray);
    EXPECT_NEAR(std::acos(ray->z()), theta, kRoundTrip_rad);
}

TEST(Camera, SaysWhatIsWrong) {
    const auto broken = [](auto change) {
        Camera camera = test::euroc_rig().left;
        change(camera, std::get<PinholeRadTan>(camera.model));
        return camera.problem().value_or("no problem");
    };
    using Change = PinholeRadTan;
    EXPECT_EQ(broken([](Camera&, Change& m) { m.k2 = kNan; }),
              "pinhole k2 = nan is not a finite number");
    EXPECT_EQ(broken([](Camera&, Change& m) { m.fx_px = 0.0; }),
              "pinhole fx_px = 0 must be > 0 px");
    EXPECT_EQ(broken([](Camera&, Change& m) { m.fy_px = -3.0; }),
              "pinhole fy_px = -3 must be > 0 px");
    EXPECT_EQ(broken([](Camera& c, Change&) { c.width = 0; }),
              "image size 0x480 px must be between 2 and 16384 on each side");
    EXPECT_EQ(broken([](Camera& c, Change&) { c.width = 320; }),
              "principal point (367.2, 248.4) px lies outside the 320x480 image; is this the "
              "calibration of another resolution?");
    Camera fisheye = test::fisheye_rig().left;
    std::get<KannalaBrandt>(fisheye.model).k3 = kInfinity;
    EXPECT_EQ(fisheye.problem().value_or("no problem"), "fisheye k3 = inf is not a finite number");
}

}  // namespace
}  // namespace surefoot::camera
