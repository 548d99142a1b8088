// SPDX-License-Identifier: Apache-2.0
#include "surefoot/core/pose.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/rng.hpp"

namespace surefoot {
namespace {

constexpr double kRounding = 1e-12;

Pose random_pose(Rng& rng, double max_angle_rad = 3.0) {
    Vector6 delta;
    for (int i = 0; i < 3; ++i) delta[i] = rng.uniform(-5.0, 5.0);
    Eigen::Vector3d axis(rng.normal(), rng.normal(), rng.normal());
    delta.tail<3>() = axis.normalized() * rng.uniform(0.0, max_angle_rad);
    return perturbed(Pose{}, delta);
}

TEST(Pose, inner_names_cancel) {
    Rng rng(1);
    for (int trial = 0; trial < 50; ++trial) {
        const Pose T_a_b = random_pose(rng);
        const Pose T_b_c = random_pose(rng);
        const Eigen::Vector3d p_c(rng.normal(), rng.normal(), rng.normal());
        EXPECT_LT(((T_a_b * T_b_c) * p_c - T_a_b * (T_b_c * p_c)).norm(), 1e3 * kRounding);
        EXPECT_LT((T_a_b.inverse() * (T_a_b * p_c) - p_c).norm(), 1e3 * kRounding);
        EXPECT_LT((Pose::from_matrix(T_a_b.matrix()).matrix() - T_a_b.matrix()).norm(),
                  1e3 * kRounding);
    }
}

TEST(Pose, difference_undoes_perturbed_at_small_and_large_angles) {
    Rng rng(2);
    for (const double scale : {1e-9, 1e-4, 0.1, 3.1}) {
        for (int trial = 0; trial < 20; ++trial) {
            const Pose T = random_pose(rng);
            Vector6 delta;
            for (int i = 0; i < 3; ++i) delta[i] = rng.uniform(-1.0, 1.0);
            delta.tail<3>() =
                Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized() * scale;
            EXPECT_LT((difference(T, perturbed(T, delta)) - delta).norm(), 1e-9)
                << "angle " << scale;
        }
    }
}

TEST(Pose, rotation_vector_of_a_half_turn_is_finite) {
    const Eigen::Vector3d half_turn(0.0, 0.0, M_PI);
    EXPECT_NEAR(log_so3(exp_so3(half_turn)).norm(), M_PI, 1e-9);
    EXPECT_EQ(log_so3(Eigen::Quaterniond::Identity()).norm(), 0.0);
}

TEST(Pose, optical_axes_turn_into_body_axes) {
    const Pose T = T_body_optical();
    EXPECT_LT((T * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(),
              kRounding);  // forward
    EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, -1, 0)).norm(),
              kRounding);  // right
    EXPECT_LT((T * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(0, 0, -1)).norm(),
              kRounding);  // down
}

TEST(Pose, composed_covariance_matches_sampling) {
    Rng rng(3);
    const Pose T_a_b = random_pose(rng);
    const Pose T_b_c = random_pose(rng);
    Vector6 sigma_ab;
    Vector6 sigma_bc;
    sigma_ab << 0.01, 0.02, 0.03, 0.004, 0.002, 0.003;
    sigma_bc << 0.02, 0.01, 0.01, 0.001, 0.003, 0.002;
    const Matrix6 expected = compose_covariance(
        sigma_ab.cwiseAbs2().asDiagonal(), T_b_c, sigma_bc.cwiseAbs2().asDiagonal());

    constexpr int kSamples = 20000;
    Matrix6 sampled = Matrix6::Zero();
    for (int sample = 0; sample < kSamples; ++sample) {
        Vector6 noise_ab;
        Vector6 noise_bc;
        for (int i = 0; i < 6; ++i) {
            noise_ab[i] = sigma_ab[i] * rng.normal();
            noise_bc[i] = sigma_bc[i] * rng.normal();
        }
        const Vector6 error =
            difference(T_a_b * T_b_c, perturbed(T_a_b, noise_ab) * perturbed(T_b_c, noise_bc));
        sampled += error * error.transpose() / kSamples;
    }
    // The standard error of a sampled variance is sqrt(2/n) = 1 % of it; 5 of them.
    EXPECT_LT((sampled - expected).norm(), 0.05 * expected.norm()) << sampled << "\n\n" << expected;
}

TEST(Pose, interpolation_meets_both_ends) {
    Rng rng(4);
    const Pose a = random_pose(rng, 1.0);
    const Pose b = random_pose(rng, 1.0);
    EXPECT_LT(difference(interpolate(a, b, 0.0), a).norm(), 1e-9);
    EXPECT_LT(difference(interpolate(a, b, 1.0), b).norm(), 1e-9);
}

}  // namespace
}  // namespace surefoot
