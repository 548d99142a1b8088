// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/cloud_alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3f;
using Points = std::vector<Vector3f>;

constexpr double kNoise_m = 0.002;

/// A corner of a room: floor and two walls, or the floor alone.
Points corner(std::size_t count, bool walls, std::uint64_t seed) {
    Rng rng(seed);
    Points points_m;
    for (std::size_t i = 0; i < count; ++i) {
        Eigen::Vector3d p_m(rng.uniform(0.0, 2.0), rng.uniform(0.0, 2.0), rng.uniform(0.0, 2.0));
        p_m[walls ? static_cast<Eigen::Index>(rng.below(3)) : 2] = 0.0;
        p_m += kNoise_m * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
        points_m.push_back(p_m.cast<float>());
    }
    return points_m;
}

Points moved_by(const Pose& T, const Points& points_m) {
    Points moved_m;
    for (const Vector3f& p_m : points_m) moved_m.push_back((T * p_m.cast<double>()).cast<float>());
    return moved_m;
}

const Pose kTruth{exp_so3({0.01, -0.02, 0.025}), {0.03, -0.02, 0.04}};  // 2 deg, 54 mm

struct Error {
    double place_m;
    double turn_rad;
};
/// Error at the middle of the corner.
Error error_of(const Pose& T_reference_moved) {
    const Pose rest = T_reference_moved * kTruth;
    const Eigen::Vector3d middle_m(1.0, 1.0, 1.0);
    return {(rest * middle_m - middle_m).norm(), Eigen::AngleAxisd(rest.rotation).angle()};
}

TEST(CloudAlignment, FindsHowACloudWasMoved) {
    const KdTree reference(corner(20000, true, 1));
    const Points moved_m = moved_by(kTruth, corner(20000, true, 2));
    const CloudAlignment found = align_clouds(reference, moved_m, Pose{}, {});
    EXPECT_TRUE(found.converged());
    EXPECT_EQ(found.free_directions, 0);
    const Error error = error_of(found.T_reference_moved);
    // The noise of both clouds over 20 000 pairs allows 0.03 mm; the normals of 30 points add to
    // it.
    EXPECT_LT(error.place_m, 5e-4);
    EXPECT_LT(error.turn_rad, 5e-4);
    EXPECT_LT(found.steps.back().rms_m, 2.0 * kNoise_m);
    EXPECT_GT(found.sigma_m, 1e-5);
    EXPECT_LT(found.sigma_m, 5e-4);
    EXPECT_GT(found.steps.front().rms_m, 5.0 * found.steps.back().rms_m);
    EXPECT_EQ(found.steps.back().pairs, 20000);
}

TEST(CloudAlignment, SameBytesInEveryRunAndForAnyNumberOfThreads) {
    const Points points_m = corner(20000, true, 3);
    const Points moved_m = moved_by(kTruth, corner(20000, true, 4));
    Backwards backwards;
    Threads threads(3);
    const CloudAlignment one = align_clouds(KdTree(points_m), moved_m, Pose{}, {});
    for (Executor* executor :
         {static_cast<Executor*>(&backwards), static_cast<Executor*>(&threads), &serial()}) {
        const CloudAlignment other =
            align_clouds(KdTree(points_m, *executor), moved_m, Pose{}, {}, *executor);
        EXPECT_EQ(other.T_reference_moved.translation_m, one.T_reference_moved.translation_m);
        EXPECT_EQ(other.T_reference_moved.rotation.coeffs(),
                  one.T_reference_moved.rotation.coeffs());
        EXPECT_EQ(other.steps.size(), one.steps.size());
    }
}

TEST(CloudAlignment, ABareFloorLeavesTheGuessWhereItHoldsNothing) {
    const KdTree reference(corner(20000, false, 5));
    const Pose lifted{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.03}};
    const Pose guess{Eigen::Quaterniond::Identity(), {0.011, -0.007, 0.0}};
    const Points moved_m = moved_by(lifted, corner(20000, false, 6));
    AlignmentConfig config;
    config.borders = false;
    const CloudAlignment found = align_clouds(reference, moved_m, guess, config);
    EXPECT_TRUE(found.converged());
    EXPECT_EQ(found.free_directions, 3);
    EXPECT_NEAR(found.T_reference_moved.translation_m.z(), -0.03, 3e-4);
    // Sideways the cloud moves only as much as its tilt changes.
    EXPECT_NEAR(found.T_reference_moved.translation_m.x(), 0.011, 1e-4);
    EXPECT_NEAR(found.T_reference_moved.translation_m.y(), -0.007, 1e-4);
}

TEST(CloudAlignment, WhereSurfacesHoldNothingBordersDo) {
    const KdTree reference(corner(20000, false, 5));
    const Pose off{exp_so3({0.0, 0.0, 0.005}), {0.01, -0.007, 0.03}};
    const CloudAlignment found =
        align_clouds(reference, moved_by(off, corner(20000, false, 6)), Pose{}, {});
    EXPECT_TRUE(found.converged());
    EXPECT_EQ(found.border_directions, 3);
    EXPECT_EQ(found.free_directions, 0);
    const Eigen::Vector3d middle_m(1.0, 1.0, 0.0);
    const Pose rest = found.T_reference_moved * off;
    // The mean of 30 points 14 mm apart is 5 mm off in each cloud, and moves by half of the motion
    // of the cloud. About 240 points on two borders fix each direction: 0.9 mm, one sigma.
    constexpr double kBorderSigma_m = 9e-4;
    EXPECT_LT((rest * middle_m - middle_m).norm(), 4.0 * kBorderSigma_m);
    EXPECT_LT(Eigen::AngleAxisd(rest.rotation).angle(), 4.0 * kBorderSigma_m);
}

TEST(CloudAlignment, WhereAScanEndsIsNoBorderOfThePlace) {
    // The moved cloud covers half of the floor: its new end lies in the middle of the reference.
    const KdTree reference(corner(20000, false, 5));
    Points half_m;
    for (const Vector3f& p_m : corner(20000, false, 6)) {
        if (p_m.x() < 1.0F) half_m.push_back(p_m);
    }
    const Pose off{Eigen::Quaterniond::Identity(), {0.01, -0.007, 0.0}};
    const CloudAlignment found = align_clouds(reference, moved_by(off, half_m), Pose{}, {});
    // One border remains along x. At a few points of the new end the reference seems to end too.
    // Where no other evidence fixes the direction, they shift the result by up to a tenth of the
    // balls' radius (60 mm on a border).
    const Eigen::Vector3d middle_m(0.5, 1.0, 0.0);
    EXPECT_LT((found.T_reference_moved * off * middle_m - middle_m).norm(), 6e-3);
}

TEST(CloudAlignment, TrimmingAndReachLeaveOutWhatIsNotThere) {
    const KdTree reference(corner(20000, true, 7));
    Points seen_m = corner(20000, true, 8);
    Rng rng(9);
    for (std::size_t i = 0; i < 4000; ++i) {  // a box that only the moved cloud contains
        seen_m.emplace_back(static_cast<float>(rng.uniform(0.5, 1.0)),
                            static_cast<float>(rng.uniform(0.5, 1.0)),
                            0.4F);
    }
    const Points moved_m = moved_by(kTruth, seen_m);
    const double all_m =
        error_of(align_clouds(reference, moved_m, Pose{}, {}).T_reference_moved).place_m;
    AlignmentConfig trimmed;
    trimmed.kept_share = 0.8;
    const CloudAlignment most = align_clouds(reference, moved_m, Pose{}, trimmed);
    EXPECT_LT(error_of(most.T_reference_moved).place_m, 2e-3);
    EXPECT_GT(all_m, 5.0 * error_of(most.T_reference_moved).place_m);
    AlignmentConfig near;
    near.reach_m = 0.15;
    EXPECT_LT(error_of(align_clouds(reference, moved_m, Pose{}, near).T_reference_moved).place_m,
              1e-3);
}

TEST(CloudAlignment, NoPairsMeansTheGuess) {
    AlignmentConfig near;
    near.reach_m = 0.01;
    const Pose guess{Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}};
    const CloudAlignment far =
        align_clouds(KdTree(corner(1000, true, 10)), corner(1000, true, 11), guess, near);
    EXPECT_FALSE(far.converged());
    EXPECT_EQ(far.free_directions, 6);
    EXPECT_EQ(far.T_reference_moved.translation_m, guess.translation_m);
    // A thousand copies of one point have no surface.
    const Points same(1000, Vector3f(1.0F, 2.0F, 3.0F));
    EXPECT_FALSE(align_clouds(KdTree(same), same, Pose{}, {}).converged());
}

}  // namespace
}  // namespace surefoot::geometry
