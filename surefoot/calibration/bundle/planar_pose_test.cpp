// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/planar_pose.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/bundle/relative_pose.hpp"

namespace surefoot::calibration {
namespace {

std::vector<Eigen::Vector3d> rays_to(const std::vector<Eigen::Vector3d>& points, const Pose& T) {
    std::vector<Eigen::Vector3d> rays;
    for (const Eigen::Vector3d& p : points) rays.push_back((T * p).normalized());
    return rays;
}

TEST(PlanarPose, ExactRaysGiveTheExactPose) {
    const std::vector<Eigen::Vector3d> points = Board{}.points_m();
    const std::vector<Pose> poses{
        {Eigen::Quaterniond::Identity(), {-0.1, -0.06, 0.5}},
        {exp_so3({0.6, -0.4, 2.9}), {0.2, 0.1, 0.4}},
        {exp_so3({0.0, 1.4, 0.2}), {0.6, 0.0, -0.1}},  // beyond 90 deg, as in a fisheye
    };
    for (const Pose& truth : poses) {
        const auto found = planar_pose(points, rays_to(points, truth));
        ASSERT_TRUE(found);
        EXPECT_LT(distance(truth, *found).translation_m, 1e-9);
        EXPECT_LT(distance(truth, *found).rotation_rad, 1e-9);
    }
}

TEST(PlanarPose, NeedsAPlane) {
    const std::vector<Eigen::Vector3d> all = Board{}.points_m();
    const Pose T{Eigen::Quaterniond::Identity(), {-0.1, -0.06, 0.5}};
    const std::vector<Eigen::Vector3d> row(all.begin(), all.begin() + 9);
    EXPECT_TRUE(collinear(row));
    EXPECT_FALSE(planar_pose(row, rays_to(row, T)));
    EXPECT_FALSE(planar_pose({}, {}));
    const std::vector<Eigen::Vector3d> one(5, all[3]);
    EXPECT_FALSE(planar_pose(one, rays_to(one, T)));
}

TEST(MedianPose, IsNotMovedByAMinority) {
    const Pose truth{exp_so3({0.1, -0.2, 3.0}), {0.12, 0.001, -0.002}};
    std::vector<Pose> poses;
    for (int i = -3; i <= 3; ++i) {
        Vector6 delta = Vector6::Constant(1e-4 * i);
        poses.push_back(perturbed(truth, delta));
    }
    poses[0] = {exp_so3({1.0, 0.0, 0.0}), {5.0, 5.0, 5.0}};
    poses[6] = {exp_so3({0.0, -1.5, 0.0}), {-5.0, -5.0, -5.0}};
    const PoseDistance off = distance(truth, median_pose(poses));
    EXPECT_LT(off.translation_m, 2e-4) << "the scatter of the others";
    EXPECT_LT(off.rotation_rad, 3.5e-4);
}

}  // namespace
}  // namespace surefoot::calibration
