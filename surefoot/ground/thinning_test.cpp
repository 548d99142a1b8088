// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/thinning.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace surefoot::ground {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Thinning, KeepsTheFirstPointOfAVoxelInInputOrder) {
    const Points points{{0.26, 0.0, 0.0}, {0.01, 0.0, 0.0}, {0.02, 0.0, 0.0}, {0.27, 0.01, 0.01}};
    const Points kept = thin(points, Eigen::Vector3d::Zero(), 5.0, 0.1, 100);
    EXPECT_EQ(kept, (Points{points[0], points[1]}));
}

TEST(Thinning, LeavesOutFarAndInvalidPoints) {
    const Points points{{9.0, 0, 0}, {kNaN, 0, 0}, {0, -kInfinity, 0}, {1.0, 0, 0}};
    EXPECT_EQ(thin(points, Eigen::Vector3d::Zero(), 5.0, 0.1, 100), (Points{points[3]}));
    EXPECT_TRUE(thin(Points{}, Eigen::Vector3d::Zero(), 5.0, 0.1, 100).empty());
}

TEST(Thinning, IsRelativeToTheSensor) {
    const Points kept =
        thin(Points{{1.0, 2.0, 3.0}}, Eigen::Vector3d(1.0, 1.0, 1.0), 5.0, 0.1, 100);
    EXPECT_EQ(kept, (Points{{0.0, 1.0, 2.0}}));
}

TEST(Thinning, PicksEvenlyWhenTooManyRemain) {
    Points line;
    for (int i = 0; i < 1000; ++i) line.emplace_back(0.1 * i - 50.0, 0.0, 0.0);
    const Points kept = thin(line, Eigen::Vector3d::Zero(), 100.0, 0.05, 100);
    EXPECT_EQ(kept.size(), 100U);
    EXPECT_EQ(kept.front(), line.front());
    EXPECT_EQ(kept[50], line[500]);
}

TEST(Thinning, CoveredAreaCountsSquaresNotPoints) {
    Points floor;
    for (int copy = 0; copy < 3; ++copy) {
        for (int i = 0; i < 100; ++i) {
            for (int j = 0; j < 50; ++j) floor.emplace_back(0.02 * i + 0.01, 0.02 * j + 0.01, -1.0);
        }
    }
    // 2 m x 1 m; squares on the border are covered in part.
    EXPECT_NEAR(covered_area_m2(floor, Eigen::Vector3d::UnitZ(), 0.1), 2.0, 0.35);
    EXPECT_EQ(covered_area_m2(Points{}, Eigen::Vector3d::UnitZ(), 0.1), 0.0);
}

}  // namespace
}  // namespace surefoot::ground
