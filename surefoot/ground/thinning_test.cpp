// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/thinning.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "surefoot/core/unknown.hpp"

namespace surefoot::ground {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Indices = std::vector<std::size_t>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Thinning, KeepsTheFirstPointOfAVoxelInInputOrder) {
    const Points points{{0.26, 0.0, 0.0}, {0.01, 0.0, 0.0}, {0.02, 0.0, 0.0}, {0.27, 0.01, 0.01}};
    const Indices kept = thin(points, Eigen::Vector3d::Zero(), 5.0, 0.1, 100);
    EXPECT_EQ(kept, (Indices{0, 1}));
}

TEST(Thinning, LeavesOutFarAndInvalidPoints) {
    const Points points{{9.0, 0, 0}, {kNan, 0, 0}, {0, -kInfinity, 0}, {1.0, 0, 0}};
    EXPECT_EQ(thin(points, Eigen::Vector3d::Zero(), 5.0, 0.1, 100), (Indices{3}));
    EXPECT_TRUE(thin(Points{}, Eigen::Vector3d::Zero(), 5.0, 0.1, 100).empty());
}

TEST(Thinning, RangeAndCubesAreThoseOfTheSensor) {
    const Eigen::Vector3d sensor_m(1.0, 1.0, 1.0);
    const Points points{{1.95, 1.0, 1.0}, {2.05, 1.0, 1.0}, {-0.5, 1.0, 1.0}};
    EXPECT_EQ(thin(points, sensor_m, 1.2, 1.0, 100), (Indices{0, 1}));
    EXPECT_EQ(thin(points, Eigen::Vector3d(1.5, 1.0, 1.0), 1.2, 1.0, 100), (Indices{0}));
}

TEST(Thinning, PicksEvenlyWhenTooManyRemain) {
    Points line;
    for (int i = 0; i < 1000; ++i) line.emplace_back(0.1 * i - 50.0, 0.0, 0.0);
    const Indices kept = thin(line, Eigen::Vector3d::Zero(), 100.0, 0.05, 100);
    EXPECT_EQ(kept.size(), 100U);
    EXPECT_EQ(kept.front(), 0U);
    EXPECT_EQ(kept[50], 500U);
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
