// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/motion/motion_update.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

/// Covariance of the displacement of a cell by the definition: J Sigma J^T, J = R [I, -[p_body]x].
Eigen::Matrix3d displacement_covariance(const Matrix6& covariance,
                                        const Eigen::Matrix3d& R_odom_body,
                                        const Eigen::Vector3d& r_m) {
    Eigen::Matrix<double, 3, 6> J;
    J.leftCols<3>() = R_odom_body;
    J.rightCols<3>() = -R_odom_body * skew(R_odom_body.transpose() * r_m);
    return J * covariance * J.transpose();
}

TEST(MotionUpdate, ClosedFormsMatchThePropagatedCovariance) {
    Rng rng(5);
    for (int trial = 0; trial < 200; ++trial) {
        Matrix6 A;
        for (int i = 0; i < 36; ++i) A.data()[i] = 0.01 * rng.normal();
        const Matrix6 covariance = A * A.transpose();
        const Eigen::Matrix3d R_odom_body =
            exp_so3({rng.normal(), rng.normal(), rng.normal()}).toRotationMatrix();
        const Eigen::Vector3d r_m(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-2, 1));
        const Eigen::Matrix3d expected = displacement_covariance(covariance, R_odom_body, r_m);
        const MotionNoise noise(covariance, R_odom_body);
        EXPECT_NEAR(noise.height_var_m2(r_m.x(), r_m.y()), expected(2, 2), 1e-12)
            << "trial " << trial;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(expected.topLeftCorner<2, 2>());
        EXPECT_NEAR(
            noise.horizontal_var_m2(r_m.x(), r_m.y(), r_m.z()), eigen.eigenvalues()(1), 1e-12)
            << "trial " << trial;
    }
}

TEST(MotionUpdate, ARowOfCellsIsWhatTheFormsSayCellByCell) {
    constexpr int kCells = 37;  // no register divides it
    Rng rng(6);
    for (int trial = 0; trial < 50; ++trial) {
        Matrix6 A;
        for (int i = 0; i < 36; ++i) A.data()[i] = 0.002 * rng.normal();
        const MotionNoise noise(A * A.transpose(),
                                exp_so3({rng.normal(), 0.0, 0.3}).toRotationMatrix());
        const MotionNoise::Row row{-1.9, rng.uniform(-3.0, 3.0), 0.1, 1.5};
        std::vector<float> height_m(kCells);
        std::vector<float> var_m2(kCells, 1e-6F);
        std::vector<float> drift_m(kCells, 0.001F);
        for (float& h_m : height_m) h_m = static_cast<float>(rng.uniform(-0.5, 2.5));
        height_m[5] = std::nanf("");
        drift_m[5] = std::nanf("");
        noise.blur_row(row, kCells, height_m.data(), var_m2.data(), drift_m.data());
        for (int i = 0; i < kCells; ++i) {
            const auto at = static_cast<std::size_t>(i);
            if (i == 5) {
                EXPECT_TRUE(std::isnan(drift_m[at]));
                continue;
            }
            const double x_m = row.first_x_m + row.step_m * i;
            const double z_m = static_cast<double>(height_m[at]) - row.body_z_m;
            const double height_m2 = 1e-6 + noise.height_var_m2(x_m, row.y_m);
            const double across_m2 = 1e-6 + noise.horizontal_var_m2(x_m, row.y_m, z_m);
            // Ten roundings of floats on terms that may cancel to a tenth.
            constexpr double kRelative = 10.0 * 6e-8 * 10.0;
            EXPECT_NEAR(static_cast<double>(var_m2[at]) / height_m2, 1.0, kRelative) << i;
            EXPECT_NEAR(static_cast<double>(drift_m[at]) / std::sqrt(across_m2), 1.0, kRelative)
                << i;
        }
    }
}

TEST(MotionUpdate, TiltLiftsWhatIsFarAndYawLiftsNothing) {
    Matrix6 pitch = Matrix6::Zero();
    pitch(4, 4) = 1e-4;  // (0.01 rad)^2 about y
    const MotionNoise pitched(pitch, Eigen::Matrix3d::Identity());
    EXPECT_NEAR(std::sqrt(pitched.height_var_m2(2.0, 0.0)), 0.02, 1e-15);
    EXPECT_EQ(pitched.height_var_m2(0.0, 2.0), 0.0);
    EXPECT_NEAR(std::sqrt(pitched.horizontal_var_m2(2.0, 0.0, -1.0)), 0.01, 1e-15);

    Matrix6 yaw = Matrix6::Zero();
    yaw(5, 5) = 1e-4;
    const MotionNoise yawed(yaw, Eigen::Matrix3d::Identity());
    EXPECT_EQ(yawed.height_var_m2(2.0, 1.0), 0.0);
    EXPECT_NEAR(std::sqrt(yawed.horizontal_var_m2(3.0, 4.0, 0.0)), 0.05, 1e-15);
}

TEST(MotionUpdate, MonteCarloOfPerturbedPosesShowsTheSameSpread) {
    Matrix6 covariance = Matrix6::Zero();
    covariance.diagonal() << 4e-6, 1e-6, 9e-6, 1e-4, 2e-4, 3e-4;
    const Pose T_odom_body{exp_so3({0.1, -0.2, 0.7}), {1.0, 2.0, 3.0}};
    const Eigen::Vector3d p_odom_m(2.2, 1.1, 2.0);
    const Eigen::Vector3d p_body_m = T_odom_body.inverse() * p_odom_m;
    Rng rng(8);
    constexpr int kDraws = 40000;
    double sum_sq_m2 = 0.0;
    for (int k = 0; k < kDraws; ++k) {
        Vector6 delta;
        for (int i = 0; i < 6; ++i) delta(i) = std::sqrt(covariance(i, i)) * rng.normal();
        const double dz_m = (perturbed(T_odom_body, delta) * p_body_m).z() - p_odom_m.z();
        sum_sq_m2 += dz_m * dz_m;
    }
    const Eigen::Vector3d r_m = p_odom_m - T_odom_body.translation_m;
    const double expected_m2 =
        MotionNoise(covariance, T_odom_body.R()).height_var_m2(r_m.x(), r_m.y());
    // A variance from n draws has the relative error sqrt(2/n); the limit is four times that, plus
    // second order terms.
    EXPECT_NEAR(sum_sq_m2 / kDraws / expected_m2, 1.0, 4.0 * std::sqrt(2.0 / kDraws) + 0.002);
}

TEST(MotionUpdate, KnowsNothingFromAnInfiniteCovariance) {
    Matrix6 covariance = Matrix6::Zero();
    EXPECT_TRUE(MotionNoise(covariance, Eigen::Matrix3d::Identity()).is_zero());
    covariance(2, 2) = INFINITY;
    EXPECT_FALSE(MotionNoise(covariance, Eigen::Matrix3d::Identity()).is_finite());
    covariance(2, 2) = -1.0;  // rounding of a subtraction may give a small negative variance
    EXPECT_EQ(MotionNoise(covariance, Eigen::Matrix3d::Identity()).height_var_m2(0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace surefoot::elevation
