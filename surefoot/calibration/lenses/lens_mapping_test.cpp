// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/lenses/lens_mapping.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/calibration/mono_calibration.hpp"
#include "surefoot/calibration/synthetic_views_testing.hpp"

namespace surefoot::calibration {
namespace {

constexpr ImageSize kSize{752, 480};

Eigen::VectorXd values(std::initializer_list<double> list) {
    Eigen::VectorXd result(static_cast<Eigen::Index>(list.size()));
    std::copy(list.begin(), list.end(), result.begin());
    return result;
}

TEST(LensMapping, OfAPlainLensIsWhatTheFormulaSays) {
    // u = f x + c: independent deviations of f and c move a pixel by x df + dc.
    const Eigen::VectorXd lens = values({400, 410, 375, 240, 0, 0, 0, 0});
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
    covariance.diagonal().head<4>() << 4.0, 9.0, 0.25, 0.16;
    // The rounding of a pixel, 1e-13, divided by the step of the differences, 1e-5, with a margin.
    constexpr double kRounding_px2 = 1e-7;
    const Eigen::Vector2d pixel(575.0, 35.0);  // x = 0.5, y = -0.5
    const auto moved = mapping_covariance_px2(LensKind::pinhole4, lens, covariance, pixel);
    ASSERT_TRUE(moved);
    EXPECT_NEAR((*moved)(0, 0), 0.25 * 4.0 + 0.25, kRounding_px2);
    EXPECT_NEAR((*moved)(1, 1), 0.25 * 9.0 + 0.16, kRounding_px2);
    EXPECT_NEAR((*moved)(0, 1), 0.0, kRounding_px2);
    // The worst position is the left or right border, |x| = 376 / 400, or the upper border.
    const MappingSigmas sigmas = mapping_sigmas_px(LensKind::pinhole4, lens, covariance, kSize);
    const double x = 376.0 / 400.0;
    const double y = 240.0 / 410.0;
    EXPECT_GT(sigmas.median_px, std::sqrt(0.25));  // the principal point alone gives this
    EXPECT_LT(sigmas.median_px, sigmas.largest_px);
    EXPECT_NEAR(sigmas.largest_px,
                std::sqrt(std::max(x * x * 4.0 + 0.25, y * y * 9.0 + 0.16)),
                kRounding_px2);
}

TEST(LensMapping, HasNoValueWhereTheLensSeesNothing) {
    // The image folds back at r^2 = 1 / 2.4: pixels farther out have no direction.
    const Eigen::VectorXd lens = values({300, 300, 375, 240, -0.8, 0, 0, 0});
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(8, 8);
    EXPECT_FALSE(mapping_covariance_px2(LensKind::pinhole4, lens, covariance, {0.0, 0.0}));
    EXPECT_TRUE(mapping_covariance_px2(LensKind::pinhole4, lens, covariance, {375.0, 240.0}));
    EXPECT_GT(mapping_sigmas_px(LensKind::pinhole4, lens, covariance, kSize).median_px, 1.0);
}

/// Compares truth and estimate in the image. A prior fixes the coefficients themselves along the
/// direction in which they cancel.
TEST(LensMapping, OfARationalLensIsTrueWithinItsOwnUncertainty) {
    const Board board{.columns = 7, .rows = 5, .spacing_m = 0.04};
    constexpr double kNoise_px = 0.1;
    const Eigen::VectorXd truth =
        values({420.0, 421.0, 370.0, 244.0, 0.51, -0.6, 0.0004, -0.0002, 0.3, 0.8, -0.6, 0.35});
    const camera::CameraModel lens = model_of(LensKind::rational, truth);
    camera::StereoRig rig;
    rig.left = {lens, kSize.width, kSize.height};
    constexpr int kSeeds = 6;
    int pixels = 0;
    int beyond_three_sigma = 0;
    double sum = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        Rng rng(seed);
        const auto views = testing::synthetic_views(board, rig, 12, kNoise_px, rng);
        const auto result = calibrate_mono(board, views.left, kSize, LensKind::rational);
        ASSERT_TRUE(result) << "seed " << seed << ": " << result.error().message;
        for (double v = 20.0; v < kSize.height; v += 40.0) {
            for (double u = 20.0; u < kSize.width; u += 40.0) {
                const Eigen::Vector2d pixel(u, v);
                const auto ray = camera::unproject(lens, pixel);
                ASSERT_TRUE(ray);
                const auto estimate = camera::project(result->camera.model, *ray);
                const auto covariance_px2 = mapping_covariance_px2(
                    LensKind::rational, result->parameters, result->covariance, pixel);
                ASSERT_TRUE(estimate && covariance_px2) << u << ", " << v;
                const Eigen::Vector2d error = *estimate - pixel;
                const double square = error.dot(covariance_px2->ldlt().solve(error));
                ++pixels;
                sum += square;
                beyond_three_sigma += square > 11.83 ? 1 : 0;  // 99.73 % of chi square of two
            }
        }
    }
    std::printf("rational lens: mean square %.2f of 2, %.2f %% of %d pixels beyond 3 sigma\n",
                sum / pixels,
                100.0 * beyond_three_sigma / pixels,
                pixels);
    // Neighbouring pixels correlate: each seed has 12 independent parameters. The mean is therefore
    // 2 within 3.3 standard deviations (99.9 %) of chi square.
    EXPECT_NEAR(sum / pixels, 2.0, 2.0 * 3.3 * std::sqrt(2.0 / (12.0 * kSeeds)));
    EXPECT_LE(beyond_three_sigma, pixels / 100);
}

}  // namespace
}  // namespace surefoot::calibration
