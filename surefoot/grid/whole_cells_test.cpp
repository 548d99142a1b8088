// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/whole_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot::grid {
namespace {

TEST(WholeCells, AreTheIntegerPartUpToTheMostAndNoneOfNaN) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (int i = -3; i <= 3; ++i) {
        EXPECT_EQ(whole_cells(i), i);
        EXPECT_EQ(whole_cells(i + (i < 0 ? -0.75 : 0.75)), i);
    }
    EXPECT_EQ(whole_cells(kMostCells - 0.5), kMostCells - 1);
    for (const double many : {kMostCells + 1.0, 1e10, 1e300, kInfinity}) {
        EXPECT_EQ(whole_cells(many), kMostCells) << many;
        EXPECT_EQ(whole_cells(-many), -kMostCells) << many;
    }
    EXPECT_EQ(whole_cells(std::nan("")), 0);
}

}  // namespace
}  // namespace surefoot::grid
