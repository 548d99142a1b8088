// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/trajectory/path_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::eval {
namespace {

constexpr double kRounding = 1e-9;

std::vector<PosePair> one_to_one(std::size_t count) {
    std::vector<PosePair> pairs;
    for (std::size_t k = 0; k < count; ++k) pairs.push_back({k, k});
    return pairs;
}

/// Straight on, 0.08 m a pose; the estimate goes too far by a factor and turns a little each time.
struct Walk {
    Trajectory truth;
    Trajectory estimate;
};
Walk straight_walk(int count, double scale, double turn_deg) {
    Walk walk;
    Pose T_true, T_estimated;
    const Pose step{Eigen::Quaterniond::Identity(), {0.08, 0.0, 0.0}};
    const Pose wrong{exp_so3({0.0, 0.0, turn_deg / kDegPerRad}), {0.08 * scale, 0.0, 0.0}};
    for (int k = 0; k < count; ++k) {
        walk.truth.push_back({k * 100'000'000LL, T_true});
        walk.estimate.push_back({k * 100'000'000LL, T_estimated});
        T_true = T_true * step;
        T_estimated = T_estimated * wrong;
    }
    return walk;
}

TEST(PathErrors, AScaleErrorGrowsWithTheLength) {
    const Walk walk = straight_walk(101, 1.02, 0.0);
    // 1, 5 and 9 poses on: a tenth of the length is less than a pose, only the exact end serves.
    const auto exact =
        errors_over_path(walk.estimate, walk.truth, one_to_one(101), {0.08, 0.4, 0.72});
    ASSERT_EQ(exact.size(), 3u);
    for (const PathError& error : exact) {
        EXPECT_NEAR(error.trans_rmse_m, 0.02 * error.length_m, kRounding) << error.length_m;
        EXPECT_NEAR(error.trans_percent, 2.0, 1e-6);
        EXPECT_NEAR(error.rot_rmse_deg, 0.0, 1e-6);
        EXPECT_EQ(error.count, 101 - std::lround(error.length_m / 0.08));
    }
    // Of longer ones some are a little off; their share of the error is not.
    for (const PathError& error :
         errors_over_path(walk.estimate, walk.truth, one_to_one(101), {1.0, 2.0, 5.0})) {
        EXPECT_NEAR(error.trans_percent, 2.0, 1e-6) << error.length_m;
        EXPECT_NEAR(error.trans_rmse_m, 0.02 * error.length_m, 0.1 * 0.02 * error.length_m);
    }
}

TEST(PathErrors, TurningIsFoundPerLength) {
    const Walk walk = straight_walk(101, 1.0, 0.1);
    const auto errors =
        errors_over_path(walk.estimate, walk.truth, one_to_one(101), {0.4, 0.72, 100.0});
    EXPECT_NEAR(errors[0].rot_rmse_deg, 0.5, 1e-6);
    EXPECT_NEAR(errors[1].rot_rmse_deg, 0.9, 1e-6);
    EXPECT_EQ(errors[2].count, 0);
    EXPECT_TRUE(std::isnan(errors[2].trans_rmse_m));
    EXPECT_TRUE(std::isnan(errors[2].trans_percent));
}

/// Reference implementation of the rule: tries all later poses.
std::vector<PosePair> stretches_slowly(const Trajectory& truth, double length_m) {
    std::vector<PosePair> found;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        double path_m = 0.0;
        double best_m = 1e9;
        std::size_t best = 0;
        for (std::size_t j = i + 1; j < truth.size(); ++j) {
            path_m +=
                (truth[j].T_world_body.translation_m - truth[j - 1].T_world_body.translation_m)
                    .norm();
            if (std::abs(path_m - length_m) < best_m - 1e-12) {
                best_m = std::abs(path_m - length_m);
                best = j;
            }
        }
        if (best_m <= 0.1 * length_m) found.push_back({i, best});
    }
    return found;
}

TEST(PathErrors, AgreeWithTheRuleOnAWalkThatStopsAndGoes) {
    Rng rng(3);
    for (int trial = 0; trial < 20; ++trial) {
        Trajectory truth, estimate;
        Pose T;
        for (int k = 0; k < 120; ++k) {
            if (rng.uniform() < 0.6) {  // otherwise the camera stands still
                T = T * Pose{exp_so3({0.0, 0.0, 0.1 * rng.normal()}), {rng.uniform(0, 0.1), 0, 0}};
            }
            truth.push_back({k, T});
            Vector6 noise;
            for (int i = 0; i < 6; ++i) noise[i] = 0.01 * rng.normal();
            estimate.push_back({k, perturbed(T, noise)});
        }
        for (const double length_m : {0.1, 0.5, 2.0}) {
            const auto stretches = stretches_slowly(truth, length_m);
            double trans_sq = 0.0, rot_sq = 0.0;
            for (const PosePair& s : stretches) {
                const Eigen::Matrix4d Q = truth[s.estimate].T_world_body.matrix().inverse() *
                                          truth[s.truth].T_world_body.matrix();
                const Eigen::Matrix4d P = estimate[s.estimate].T_world_body.matrix().inverse() *
                                          estimate[s.truth].T_world_body.matrix();
                const Eigen::Matrix4d E = Q.inverse() * P;
                trans_sq += E.topRightCorner<3, 1>().squaredNorm();
                const double angle =
                    Eigen::AngleAxisd(Eigen::Matrix3d(E.topLeftCorner<3, 3>())).angle();
                rot_sq += angle * angle;
            }
            const auto error = errors_over_path(estimate, truth, one_to_one(120), {length_m})[0];
            ASSERT_EQ(error.count, static_cast<std::int64_t>(stretches.size())) << trial;
            if (stretches.empty()) continue;
            const auto n = static_cast<double>(stretches.size());
            EXPECT_NEAR(error.trans_rmse_m, std::sqrt(trans_sq / n), kRounding);
            EXPECT_NEAR(error.rot_rmse_deg, kDegPerRad * std::sqrt(rot_sq / n), 1e-6);
        }
    }
}

TEST(PathErrors, NothingMatchedOrNoMotionGivesNoStretch) {
    const Walk walk = straight_walk(1, 1.0, 0.0);
    EXPECT_EQ(errors_over_path({}, {}, {}, {0.1})[0].count, 0);
    EXPECT_EQ(errors_over_path(walk.estimate, walk.truth, one_to_one(1), {0.1})[0].count, 0);
    Trajectory still(5);
    EXPECT_EQ(errors_over_path(still, still, one_to_one(5), {0.1})[0].count, 0);
    EXPECT_TRUE(errors_over_path(still, still, one_to_one(5), {}).empty());
}

/// Horn 1987, "Closed-form solution of absolute orientation using unit quaternions": the rotation
/// is the eigenvector of the largest eigenvalue of a 4x4 matrix. Another road than Umeyama's.
Pose align_with_quaternions(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth) {
    const Eigen::Vector3d estimate_mean = estimate.rowwise().mean();
    const Eigen::Vector3d truth_mean = truth.rowwise().mean();
    Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < estimate.cols(); ++k)
        S += (estimate.col(k) - estimate_mean) * (truth.col(k) - truth_mean).transpose();
    Eigen::Matrix4d N;
    N << S(0, 0) + S(1, 1) + S(2, 2), S(1, 2) - S(2, 1), S(2, 0) - S(0, 2), S(0, 1) - S(1, 0),  //
        S(1, 2) - S(2, 1), S(0, 0) - S(1, 1) - S(2, 2), S(0, 1) + S(1, 0), S(2, 0) + S(0, 2),   //
        S(2, 0) - S(0, 2), S(0, 1) + S(1, 0), -S(0, 0) + S(1, 1) - S(2, 2), S(1, 2) + S(2, 1),  //
        S(0, 1) - S(1, 0), S(2, 0) + S(0, 2), S(1, 2) + S(2, 1), -S(0, 0) - S(1, 1) + S(2, 2);
    const Eigen::Vector4d q =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(N).eigenvectors().col(3);
    Pose T;
    T.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    T.translation_m = truth_mean - T.rotation * estimate_mean;
    return T;
}

/// The angle of smallest error found by trying, finer and finer.
Pose align_yaw_by_trying(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth) {
    const auto with_yaw = [&](double yaw) {
        Pose T;
        T.rotation = exp_so3({0.0, 0.0, yaw});
        T.translation_m = truth.rowwise().mean() - T.rotation * estimate.rowwise().mean().eval();
        return T;
    };
    const auto cost = [&](double yaw) {
        const Pose T = with_yaw(yaw);
        return ((T.R() * estimate).colwise() + T.translation_m - truth).squaredNorm();
    };
    double best = 0.0;
    for (double width = std::numbers::pi; width > 1e-9; width /= 10.0) {
        const double centre = best;
        for (int k = -20; k <= 20; ++k) {
            const double yaw = centre + width * k / 20.0;
            if (cost(yaw) < cost(best)) best = yaw;
        }
    }
    return with_yaw(best);
}

TEST(Alignment, Se3IsHornsAndYawTheBestOfAllAngles) {
    Rng rng(4);
    for (int trial = 0; trial < 30; ++trial) {
        Eigen::Matrix3Xd estimate(3, 20), truth(3, 20);
        const Eigen::Quaterniond turn = exp_so3({rng.normal(), rng.normal(), rng.normal()});
        for (int k = 0; k < 20; ++k) {
            estimate.col(k) = Eigen::Vector3d(rng.normal(), rng.normal(), 0.3 * rng.normal());
            truth.col(k) = turn * Eigen::Vector3d(estimate.col(k)) + Eigen::Vector3d(1, -2, 3) +
                           0.1 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
        }
        const Pose se3 = align_positions(estimate, truth, Alignment::se3);
        EXPECT_LT(difference(se3, align_with_quaternions(estimate, truth)).norm(), 1e-9) << trial;
        const Pose yaw = align_positions(estimate, truth, Alignment::yaw);
        // Cost is flat to second order: an angle is found to the root of rounding.
        EXPECT_LT(difference(yaw, align_yaw_by_trying(estimate, truth)).norm(), 1e-6) << trial;
    }
}

TEST(Alignment, AKnownAnswer) {
    // An L on the floor, turned by 90 deg about z and moved by (1, 2, 3): exact by hand.
    Eigen::Matrix3Xd estimate(3, 3), truth(3, 3);
    estimate << 0, 1, 0, 0, 0, 2, 0, 0, 0;
    truth << 1, 1, -1, 2, 3, 2, 3, 3, 3;
    for (const Alignment align : {Alignment::se3, Alignment::yaw}) {
        const Pose T = align_positions(estimate, truth, align);
        EXPECT_LT((T.translation_m - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
        EXPECT_LT((T.R() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
        EXPECT_LT((T.R() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    }
    const Pose none = align_positions(estimate, truth, Alignment::none);
    EXPECT_EQ(none.translation_m.norm(), 0.0);
}

}  // namespace
}  // namespace surefoot::eval
