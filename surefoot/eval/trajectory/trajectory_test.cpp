// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/trajectory/trajectory.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/eval/trajectory/path_errors.hpp"

namespace surefoot::eval {
namespace {

constexpr double kRounding = 1e-9;  ///< positions of some ten metres in double precision
constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;

/// A smooth walk with turns in all axes.
Trajectory walk(int count, double rate_hz, double start_s = 0.0) {
    Trajectory trajectory;
    for (int k = 0; k < count; ++k) {
        const double t = start_s + k / rate_hz;
        Pose pose;
        pose.translation_m = {3.0 * std::sin(0.3 * t), 0.5 * t, 0.2 * std::sin(0.9 * t)};
        pose.rotation = exp_so3({0.1 * std::sin(t), 0.2 * std::cos(0.7 * t), 0.3 * t});
        trajectory.push_back({ns_from_seconds(t), pose});
    }
    return trajectory;
}

Pose random_pose(Rng& rng) {
    Pose pose;
    pose.translation_m = {rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-5, 5)};
    pose.rotation = exp_so3({rng.normal(), rng.normal(), rng.normal()});
    return pose;
}

double sum_sq(const Pose& T, const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < estimate.cols(); ++k) {
        sum += (T * Eigen::Vector3d(estimate.col(k)) - truth.col(k)).squaredNorm();
    }
    return sum;
}

/// Reference implementation: takes the closest pair of all remaining pairs, again and again.
std::vector<PosePair> associate_slowly(const Trajectory& estimate,
                                       const Trajectory& truth,
                                       std::int64_t tolerance_ns) {
    std::vector<PosePair> pairs;
    std::vector<bool> used_e(estimate.size()), used_t(truth.size());
    while (true) {
        std::int64_t best = tolerance_ns + 1;
        PosePair pair;
        for (std::size_t e = 0; e < estimate.size(); ++e) {
            for (std::size_t t = 0; t < truth.size(); ++t) {
                const auto difference = std::abs(estimate[e].time_ns - truth[t].time_ns);
                if (used_e[e] || used_t[t] || difference > tolerance_ns) continue;
                const bool tie = difference == best;
                const auto earlier = [](const StampedPose& a, const StampedPose& b) {
                    return a.time_ns < b.time_ns;
                };
                const bool first_of_tie =
                    tie && (earlier(estimate[e], estimate[pair.estimate]) ||
                            (e == pair.estimate && earlier(truth[t], truth[pair.truth])));
                if (difference < best || first_of_tie) {
                    best = difference;
                    pair = {e, t};
                }
            }
        }
        if (best > tolerance_ns) break;
        used_e[pair.estimate] = used_t[pair.truth] = true;
        pairs.push_back(pair);
    }
    std::sort(pairs.begin(), pairs.end(), [&](const PosePair& a, const PosePair& b) {
        return estimate[a.estimate].time_ns < estimate[b.estimate].time_ns;
    });
    return pairs;
}

TEST(Trajectory, ARigidlyMovedTruthHasNoError) {
    Rng rng(1);
    const Trajectory truth = walk(200, 15.0);
    for (int trial = 0; trial < 20; ++trial) {
        const Pose T_truth_estimate = random_pose(rng);
        const Trajectory estimate = transformed(T_truth_estimate.inverse(), truth);
        const auto errors = evaluate_trajectory(estimate, truth, {});
        ASSERT_TRUE(errors.ok());
        EXPECT_EQ(errors->matched, 200);
        EXPECT_NEAR(errors->ate_rmse_m, 0.0, kRounding);
        EXPECT_NEAR(errors->rpe_trans_rmse_m, 0.0, kRounding);
        EXPECT_NEAR(errors->rpe_rot_rmse_deg, 0.0, 1e-6);  // arc of a rounded quaternion product
        EXPECT_NEAR(errors->drift_percent, 0.0, 1e-6);
        EXPECT_NEAR(difference(errors->T_truth_estimate, T_truth_estimate).norm(), 0.0, 1e-8);
    }
}

TEST(Trajectory, WhiteNoiseOfKnownSizeIsFound) {
    Rng rng(2);
    const Trajectory truth = walk(2000, 15.0);
    Trajectory estimate = transformed(random_pose(rng), truth);
    constexpr double kSigma_m = 0.01;
    for (StampedPose& pose : estimate) {
        pose.T_world_body.translation_m +=
            kSigma_m * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    }
    const auto errors = evaluate_trajectory(estimate, truth, {});
    ASSERT_TRUE(errors.ok());
    // 3 axes; 6000 draws fix their rms to 0.9 %, 4 standard deviations allowed.
    EXPECT_NEAR(errors->ate_rmse_m, kSigma_m * std::sqrt(3.0), 0.04 * kSigma_m * std::sqrt(3.0));
    // Two independent ends per relative motion.
    EXPECT_NEAR(
        errors->rpe_trans_rmse_m, kSigma_m * std::sqrt(6.0), 0.05 * kSigma_m * std::sqrt(6.0));
}

TEST(Trajectory, NoOtherAlignmentIsBetter) {
    Rng rng(3);
    for (int trial = 0; trial < 30; ++trial) {
        const bool planar = trial % 3 == 0;  // a flat cloud tempts into a reflection
        Eigen::Matrix3Xd truth(3, 12), estimate(3, 12);
        const Pose T = random_pose(rng);
        for (int k = 0; k < 12; ++k) {
            const Eigen::Vector3d p(rng.normal(), rng.normal(), planar ? 0.0 : rng.normal());
            truth.col(k) = p;
            estimate.col(k) =
                T * p + 0.3 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
        }
        for (const Alignment align : {Alignment::se3, Alignment::yaw}) {
            const Pose best = align_positions(estimate, truth, align);
            EXPECT_NEAR(best.R().determinant(), 1.0, 1e-12);
            for (int axis = 0; axis < 6; ++axis) {
                if (align == Alignment::yaw && (axis == 3 || axis == 4)) continue;
                for (const double step : {-0.3, -1e-3, 1e-3, 0.3}) {
                    Pose other = best;
                    if (axis < 3) {
                        other.translation_m[axis] += step;
                    } else {
                        Eigen::Vector3d turn = Eigen::Vector3d::Zero();
                        turn[axis - 3] = step;
                        other.rotation = exp_so3(turn) * other.rotation;
                    }
                    EXPECT_GE(sum_sq(other, estimate, truth), sum_sq(best, estimate, truth))
                        << "trial " << trial << " axis " << axis << " step " << step;
                }
            }
        }
    }
}

TEST(Trajectory, YawAlignmentKeepsTilt) {
    const Trajectory truth = walk(100, 15.0);
    const Pose level{exp_so3({0.0, 0.0, 1.1}), {1.0, 2.0, 3.0}};
    const Pose tilted{exp_so3({0.1, 0.0, 0.0}), {1.0, 2.0, 3.0}};
    EvalTrajectoryConfig config;
    config.align = Alignment::yaw;
    EXPECT_NEAR(
        evaluate_trajectory(transformed(level, truth), truth, config)->ate_rmse_m, 0.0, kRounding);
    EXPECT_GT(evaluate_trajectory(transformed(tilted, truth), truth, config)->ate_rmse_m, 0.05);
    config.align = Alignment::none;
    const Pose shifted{Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.4}};
    EXPECT_NEAR(evaluate_trajectory(transformed(shifted, truth), truth, config)->ate_rmse_m,
                0.5,
                kRounding);
}

TEST(Trajectory, AssociationIsTheClosestFirstOneToOne) {
    Rng rng(4);
    for (int trial = 0; trial < 200; ++trial) {
        Trajectory estimate(rng.below(12)), truth(rng.below(12));
        for (auto* trajectory : {&estimate, &truth}) {
            for (StampedPose& pose : *trajectory) {
                pose.time_ns =
                    static_cast<std::int64_t>(rng.below(40)) * 1'000'000;  // ties are frequent
            }
            // Equal stamps within one trajectory have no defined order in the slow version.
            std::sort(trajectory->begin(), trajectory->end(), [](const auto& a, const auto& b) {
                return a.time_ns > b.time_ns;
            });
            trajectory->erase(
                std::unique(trajectory->begin(),
                            trajectory->end(),
                            [](const auto& a, const auto& b) { return a.time_ns == b.time_ns; }),
                trajectory->end());
        }
        EXPECT_EQ(associate(estimate, truth, 0.010), associate_slowly(estimate, truth, 10'000'000))
            << "trial " << trial;
    }
}

TEST(Trajectory, ToleranceIncludesItsEnd) {
    const Trajectory truth = {{0, {}}};
    EXPECT_EQ(associate({{10'000'000, {}}}, truth, 0.010).size(), 1u);
    EXPECT_EQ(associate({{10'000'001, {}}}, truth, 0.010).size(), 0u);
    EXPECT_EQ(associate({{-10'000'000, {}}}, truth, 0.010).size(), 1u);
    EXPECT_EQ(associate({{-10'000'001, {}}}, truth, 0.010).size(), 0u);
}

TEST(Trajectory, UnequalRatesMatchTheNearestPose) {
    const Trajectory truth = walk(2000, 200.0);
    const Trajectory estimate = walk(140, 15.0, 0.001);
    const auto errors = evaluate_trajectory(estimate, truth, {});
    ASSERT_TRUE(errors.ok());
    EXPECT_EQ(errors->matched, 140);
    for (const PosePair& pair : errors->pairs) {
        // Half of the truth's period.
        EXPECT_LE(std::abs(estimate[pair.estimate].time_ns - truth[pair.truth].time_ns), 2'500'000);
    }
    EXPECT_LT(errors->ate_rmse_m,
              0.0025 * 1.2);  // half a period at the walk's top speed of 1.1 m/s
}

TEST(Trajectory, RelativeErrorPerFrameAndPerSecond) {
    // Straight walk at 1 m/s, 10 Hz; the estimate turns 0.2 deg too far and goes 1 mm too far each
    // frame.
    Trajectory truth, estimate;
    Pose T_true, T_estimated;
    const Pose step{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}};
    const Pose wrong_step{exp_so3({0.0, 0.0, 0.2 / kDegPerRad}), {0.101, 0.0, 0.0}};
    for (int k = 0; k <= 100; ++k) {
        truth.push_back({k * 100'000'000LL, T_true});
        estimate.push_back({k * 100'000'000LL, T_estimated});
        T_true = T_true * step;
        T_estimated = T_estimated * wrong_step;
    }
    EvalTrajectoryConfig config;
    for (const Alignment align : {Alignment::se3, Alignment::yaw, Alignment::none}) {
        config.align = align;
        config.rpe_interval_s = 0.0;
        const auto per_frame = evaluate_trajectory(estimate, truth, config);
        EXPECT_NEAR(per_frame->rpe_rot_rmse_deg, 0.2, 1e-6);
        EXPECT_NEAR(per_frame->rpe_trans_rmse_m, 0.001, kRounding);
        config.rpe_interval_s = 1.0;
        EXPECT_NEAR(evaluate_trajectory(estimate, truth, config)->rpe_rot_rmse_deg, 2.0, 1e-6);
        config.rpe_interval_s = 0.97;  // the nearest pose is 1 s later
        EXPECT_NEAR(evaluate_trajectory(estimate, truth, config)->rpe_rot_rmse_deg, 2.0, 1e-6);
    }
}

/// Four corners of a square of 2 m, one a second, heading along its sides. The estimate is higher
/// and lower by `kBump_m` in turn, which no rotation or translation can take away, and has turned
/// too far by `kTurn_deg`. All figures below follow from it by hand.
constexpr double kBump_m = 0.1;
constexpr double kTurn_deg[] = {0.0, 1.0, 3.0, 6.0};

struct Square {
    Trajectory truth;
    Trajectory estimate;
};
Square square(const Pose& T_estimate_truth) {
    Square result;
    const Eigen::Vector3d corners_m[] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    for (int k = 0; k < 4; ++k) {
        const double yaw_deg = 90.0 * k;
        const std::int64_t time_ns = k * 1'000'000'000LL;
        const double bump_m = k % 2 == 0 ? kBump_m : -kBump_m;
        const Pose truth{exp_so3({0.0, 0.0, yaw_deg / kDegPerRad}), corners_m[k]};
        const Pose estimate{exp_so3({0.0, 0.0, (yaw_deg + kTurn_deg[k]) / kDegPerRad}),
                            corners_m[k] + Eigen::Vector3d(0.0, 0.0, bump_m)};
        result.truth.push_back({time_ns, truth});
        result.estimate.push_back({time_ns, T_estimate_truth * estimate});
    }
    return result;
}

double ate_m(const Square& walk, Alignment align) {
    EvalTrajectoryConfig config;
    config.align = align;
    return evaluate_trajectory(walk.estimate, walk.truth, config)->ate_rmse_m;
}

TEST(Trajectory, AteByHandForEachAlignment) {
    // Turned by 90 deg about z and shifted by (5, -3, 1): x, y, z come to 5 - y, x - 3, z + 1.
    const Square turned =
        square({exp_so3({0.0, 0.0, 90.0 / kDegPerRad}), Eigen::Vector3d(5.0, -3.0, 1.0)});
    EXPECT_NEAR(ate_m(turned, Alignment::se3), kBump_m, kRounding);
    EXPECT_NEAR(ate_m(turned, Alignment::yaw), kBump_m, kRounding);
    // Squares of the distances: 34, 10, 10, 34 along the ground, (1 +- bump)^2 upwards.
    EXPECT_NEAR(ate_m(turned, Alignment::none), std::sqrt(23.0 + kBump_m * kBump_m), kRounding);
    // Turned by 90 deg about x: x, y, z come to x, -z, y. No yaw helps, the mean is taken away.
    const Square tilted = square({exp_so3({90.0 / kDegPerRad, 0.0, 0.0}), {0.0, 0.0, 0.0}});
    EXPECT_NEAR(ate_m(tilted, Alignment::se3), kBump_m, kRounding);
    EXPECT_NEAR(ate_m(tilted, Alignment::yaw), std::sqrt(2.0 + kBump_m * kBump_m), kRounding);
}

/// Squared error of a stretch of `chord_m` on the ground, begun `turn_deg` too far to the left.
double turned_sq_m2(double chord_m, double turn_deg) {
    const double off_m = 2.0 * chord_m * std::sin(0.5 * turn_deg / kDegPerRad);
    return off_m * off_m;
}

TEST(Trajectory, RpeByHandAtSeveralLengths) {
    const double up_sq_m2 = 4.0 * kBump_m * kBump_m;  // stretches between a high and a low pose
    const double side_m = std::sqrt((3.0 * up_sq_m2 + turned_sq_m2(2.0, 0.0) +
                                     turned_sq_m2(2.0, 1.0) + turned_sq_m2(2.0, 3.0)) /
                                    3.0);
    const double side_deg = std::sqrt((1.0 + 4.0 + 9.0) / 3.0);
    const double diagonal_m = std::sqrt(0.5 * turned_sq_m2(std::sqrt(8.0), 1.0));
    const double diagonal_deg = std::sqrt((9.0 + 25.0) / 2.0);
    Rng rng(7);
    for (const Alignment align : {Alignment::se3, Alignment::yaw, Alignment::none}) {
        const Square walk = square(random_pose(rng));  // no alignment plays a part
        EvalTrajectoryConfig config;
        config.align = align;
        const auto sides = evaluate_trajectory(walk.estimate, walk.truth, config);
        EXPECT_NEAR(sides->rpe_trans_rmse_m, side_m, kRounding);
        EXPECT_NEAR(sides->rpe_rot_rmse_deg, side_deg, 1e-6);
        EXPECT_NEAR(sides->end_error_m, 2.0 * kBump_m, kRounding);
        EXPECT_NEAR(sides->drift_percent, 100.0 * 2.0 * kBump_m / 6.0, 1e-6);
        config.rpe_interval_s = 2.0;
        const auto diagonals = evaluate_trajectory(walk.estimate, walk.truth, config);
        EXPECT_NEAR(diagonals->rpe_trans_rmse_m, diagonal_m, kRounding);
        EXPECT_NEAR(diagonals->rpe_rot_rmse_deg, diagonal_deg, 1e-6);

        const auto by_path = errors_over_path(walk.estimate, walk.truth, sides->pairs, {2, 4, 6});
        EXPECT_EQ(by_path[0].count, 3);
        EXPECT_NEAR(by_path[0].trans_rmse_m, side_m, kRounding);
        EXPECT_NEAR(by_path[0].rot_rmse_deg, side_deg, 1e-6);
        EXPECT_EQ(by_path[1].count, 2);
        EXPECT_NEAR(by_path[1].trans_rmse_m, diagonal_m, kRounding);
        EXPECT_NEAR(by_path[1].rot_rmse_deg, diagonal_deg, 1e-6);
        EXPECT_EQ(by_path[2].count, 1);
        EXPECT_NEAR(by_path[2].trans_rmse_m, 2.0 * kBump_m, kRounding);
        EXPECT_NEAR(by_path[2].rot_rmse_deg, 6.0, 1e-6);
        EXPECT_NEAR(by_path[2].trans_percent, 100.0 * 2.0 * kBump_m / 6.0, 1e-6);
    }
}

TEST(Trajectory, DriftIsTheEndErrorOverThePath) {
    Trajectory truth = walk(1, 10.0), estimate = truth;
    for (int k = 1; k <= 50; ++k) {
        const Pose pose{Eigen::Quaterniond::Identity(), {0.2 * k, 0.0, 0.0}};
        truth.push_back({k * 100'000'000LL, truth[0].T_world_body * pose});
        Pose longer = pose;
        longer.translation_m *= 1.01;  // 1 % of scale
        estimate.push_back({k * 100'000'000LL, estimate[0].T_world_body * longer});
    }
    const auto errors = evaluate_trajectory(estimate, truth, {});
    EXPECT_NEAR(errors->path_length_m, 10.0, kRounding);
    EXPECT_NEAR(errors->end_error_m, 0.1, kRounding);
    EXPECT_NEAR(errors->drift_percent, 1.0, 1e-6);
}

TEST(Trajectory, StandingStillHasNoDriftFigure) {
    Trajectory still(10);
    for (int k = 0; k < 10; ++k) still[static_cast<std::size_t>(k)].time_ns = k * 50'000'000LL;
    const auto errors = evaluate_trajectory(still, still, {});
    ASSERT_TRUE(errors.ok());
    EXPECT_TRUE(std::isnan(errors->drift_percent));
    EXPECT_EQ(errors->ate_rmse_m, 0.0);
}

TEST(Trajectory, TooFewMatchesIsAnErrorInWords) {
    const Trajectory truth = walk(10, 10.0);
    const Trajectory later = walk(10, 10.0, 100.0);
    const auto errors = evaluate_trajectory(later, truth, {});
    ASSERT_FALSE(errors.ok());
    for (const char* word : {"0 poses match", "10 ms", "at least 3", "100.000 s", "0.900 s"}) {
        EXPECT_NE(errors.error().message.find(word), std::string::npos) << errors.error().message;
    }
    EXPECT_FALSE(evaluate_trajectory({}, truth, {}).ok());
    EXPECT_FALSE(evaluate_trajectory(truth, {}, {}).ok());
    EvalTrajectoryConfig two;
    two.align = Alignment::none;
    EXPECT_TRUE(evaluate_trajectory(walk(2, 10.0), truth, two).ok());
    EXPECT_FALSE(evaluate_trajectory(walk(2, 10.0), truth, {}).ok());
    two.rpe_interval_s = 30.0;
    EXPECT_NE(evaluate_trajectory(truth, truth, two).error().message.find("30 s"),
              std::string::npos);
}

TEST(Trajectory, APoseThatIsNotANumberIsNamed) {
    Trajectory truth = walk(10, 10.0), estimate = truth;
    estimate[7].T_world_body.translation_m.y() = std::numeric_limits<double>::quiet_NaN();
    const auto errors = evaluate_trajectory(estimate, truth, {});
    ASSERT_FALSE(errors.ok());
    EXPECT_NE(errors.error().message.find("pose 7 of the estimate"), std::string::npos);
    EXPECT_FALSE(evaluate_trajectory(truth, estimate, {}).ok());
}

}  // namespace
}  // namespace surefoot::eval
