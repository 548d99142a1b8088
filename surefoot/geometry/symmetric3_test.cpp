// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/symmetric3.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "surefoot/core/rng.hpp"

namespace surefoot::geometry {
namespace {

constexpr double kTurnLimit_rad = 1e-9;  // the header promises it for a unique axis

Symmetric3 from_matrix(const Eigen::Matrix3d& M) {
    return {M(0, 0), M(0, 1), M(0, 2), M(1, 1), M(1, 2), M(2, 2)};
}

/// R diag(values) R^T with a random rotation R; column 0 of R is the smallest axis.
Symmetric3 with_eigenvalues(const Eigen::Vector3d& values, Rng& rng, Eigen::Matrix3d* R_out) {
    const Eigen::Quaterniond q(rng.normal(), rng.normal(), rng.normal(), rng.normal());
    const Eigen::Matrix3d R = q.normalized().toRotationMatrix();
    if (R_out != nullptr) *R_out = R;
    const Eigen::Matrix3d M = R * values.asDiagonal() * R.transpose();
    return from_matrix(0.5 * (M + M.transpose()));
}

double angle_between_lines_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

TEST(Symmetric3, ZeroMatrixHasTheVerticalAxis) {
    const SmallestAxis axis = smallest_axis(Symmetric3{});
    EXPECT_EQ(axis.direction, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(axis.smallest, 0.0);
    EXPECT_EQ(axis.middle, 0.0);
}

TEST(Symmetric3, LinesAndSpheresGiveAUnitAxisWithoutHavingAUniqueOne) {
    for (const Symmetric3& m : {Symmetric3{1, 0, 0, 0, 0, 0},     // a line
                                Symmetric3{1, 1, 1, 1, 1, 1},     // a line, tilted
                                Symmetric3{2, 0, 0, 2, 0, 2}}) {  // a ball
        const SmallestAxis axis = smallest_axis(m);
        EXPECT_NEAR(axis.direction.norm(), 1.0, 1e-14);
        const Eigen::Vector3d residual =
            m.matrix() * axis.direction - axis.smallest * axis.direction;
        EXPECT_LE(residual.norm(), 1e-14);
    }
}

TEST(Symmetric3, ExactDiagonalKeepsItsAxis) {
    const SmallestAxis axis = smallest_axis(Symmetric3{3e-4, 0, 0, 2e-4, 0, 0});
    EXPECT_EQ(std::abs(axis.direction.z()), 1.0);
    EXPECT_NEAR(axis.smallest, 0.0, 1e-18);
    EXPECT_NEAR(axis.middle, 2e-4, 1e-18);
}

TEST(Symmetric3, SmallestAxisIsTheConstructedOneOverManyScalesAndSeparations) {
    constexpr std::uint64_t kSeed = 11;
    Rng rng(kSeed);
    for (int trial = 0; trial < 20000; ++trial) {
        const double scale = std::pow(10.0, rng.uniform(-12.0, 6.0));
        const double middle = std::pow(10.0, rng.uniform(-3.0, 0.0));
        const double smallest = middle * (1.0 - std::pow(10.0, rng.uniform(-3.0, 0.0)));
        Eigen::Matrix3d R;
        const Symmetric3 m =
            with_eigenvalues(scale * Eigen::Vector3d(smallest, middle, 1.0), rng, &R);
        const SmallestAxis axis = smallest_axis(m);
        ASSERT_LE(angle_between_lines_rad(axis.direction, R.col(0)), kTurnLimit_rad)
            << "seed " << kSeed << " trial " << trial << " eigenvalues " << smallest << ' '
            << middle;
        ASSERT_NEAR(axis.smallest / scale, smallest, 1e-12) << "trial " << trial;
        ASSERT_NEAR(axis.middle / scale, middle, 1e-11) << "trial " << trial;
    }
}

TEST(Symmetric3, JacobiAgreesWithTheIterativeOracle) {
    constexpr std::uint64_t kSeed = 12;
    Rng rng(kSeed);
    for (int trial = 0; trial < 5000; ++trial) {
        Eigen::Matrix3d M;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j <= i; ++j) M(i, j) = M(j, i) = rng.normal();  // also indefinite
        }
        const EigenSystem3 ours = eigen_system(from_matrix(M));
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> oracle(M);
        const double limit = 1e-14 * M.norm();
        ASSERT_LE((ours.values - oracle.eigenvalues()).norm(), limit) << "trial " << trial;
        const Eigen::Matrix3d rebuilt =
            ours.vectors * ours.values.asDiagonal() * ours.vectors.transpose();
        ASSERT_LE((rebuilt - M).norm(), 4.0 * limit) << "seed " << kSeed << " trial " << trial;
    }
}

TEST(Symmetric3, NearlyCollinearPointsFallBackWithoutLosingTheAxis) {
    Rng rng(13);
    for (int trial = 0; trial < 2000; ++trial) {
        Eigen::Matrix3d R;
        const Symmetric3 m = with_eigenvalues(Eigen::Vector3d(0.0, 1e-7, 1.0), rng, &R);
        const SmallestAxis axis = smallest_axis(m);
        // Rounding of the entries alone (1e-16) rotates the axis by 1e-16 / 1e-7.
        ASSERT_LE(angle_between_lines_rad(axis.direction, R.col(0)), 1e-8) << "trial " << trial;
    }
}

}  // namespace
}  // namespace surefoot::geometry
