// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/cell_groups.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

TEST(CellGroups, MatchAMapOfCells) {
    Rng rng(6);
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.125;  // exact in binary: both ways of finding the cell agree
    geometry.nx = 7;
    geometry.ny = 5;
    CellSamples samples;
    CellGroups groups;
    for (int round = 0; round < 20; ++round) {
        std::vector<GridPoint> points;
        std::map<std::size_t, std::vector<float>> truth;
        std::int64_t outside = 0;
        for (int i = 0; i < 300; ++i) {
            const GridPoint point{static_cast<float>(rng.uniform(-0.2, 1.0)),
                                  static_cast<float>(rng.uniform(-0.2, 0.8)),
                                  static_cast<float>(i),
                                  1e-6F};
            points.push_back(point);
            const auto cell =
                geometry.cell_at(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
            if (cell) {
                truth[static_cast<std::size_t>(cell->iy * geometry.nx + cell->ix)].push_back(
                    point.z_m);
            } else {
                ++outside;
            }
        }
        points.push_back({std::numeric_limits<float>::quiet_NaN(), 0.1F, 0.0F, 1e-6F});
        points.push_back({0.1F, 0.1F, std::numeric_limits<float>::infinity(), 1e-6F});
        EXPECT_EQ(samples_from_points(points, geometry, samples), outside + 2);
        groups.assign(samples, 35);
        for (std::size_t cell = 0; cell < 35; ++cell) {
            std::vector<float> heights;
            for (std::uint32_t i = groups.begin()[cell]; i < groups.begin()[cell + 1]; ++i) {
                heights.push_back(groups.z_m()[i]);
                EXPECT_EQ(groups.var_m2()[i], 1e-6F);
            }
            EXPECT_EQ(heights, truth[cell]) << "cell " << cell << " round " << round;
        }
    }
}

}  // namespace
}  // namespace surefoot::elevation
