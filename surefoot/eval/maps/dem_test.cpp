// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/dem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

using Points = std::vector<Eigen::Vector3d>;

DemGrid grid_of(const Points& points, double resolution_m, Lattice lattice) {
    CloudBounds bounds;
    bounds.add(points);
    const auto grid = bounds.grid(resolution_m, lattice);
    EXPECT_TRUE(grid.ok());
    return *grid;
}

grid::Layer dem_of(const Points& points, const DemGrid& grid, Reduce reduce) {
    DemBuilder builder(grid, reduce);
    builder.add(points);
    return builder.heights_m();
}

TEST(Dem, CellLatticeByHand) {
    const Points points = {{-0.1, 0.0, 1.0}, {0.0, 0.9, 2.0}, {0.4, 0.9, 5.0}, {0.5, 1.0, 3.0}};
    const DemGrid grid = grid_of(points, 0.5, Lattice::cell);
    // Cells [-0.5, 0), [0, 0.5), [0.5, 1) by [0, 0.5), [0.5, 1), [1, 1.5).
    EXPECT_EQ(grid.geometry.nx, 3);
    EXPECT_EQ(grid.geometry.ny, 3);
    EXPECT_EQ(grid.geometry.origin_m, Eigen::Vector2d(-0.5, 0.0));
    const auto highest = dem_of(points, grid, Reduce::max);
    EXPECT_EQ(highest.at(0, 0), 1.0F);
    EXPECT_EQ(highest.at(1, 1), 5.0F);
    EXPECT_EQ(highest.at(2, 2), 3.0F);
    EXPECT_TRUE(std::isnan(highest.at(0, 1)));
    EXPECT_EQ(dem_of(points, grid, Reduce::min).at(1, 1), 2.0F);
    EXPECT_EQ(dem_of(points, grid, Reduce::mean).at(1, 1), 3.5F);
}

TEST(Dem, NodeLatticeByHand) {
    // RASTERIZE: i = int((x - xmin) / step + 0.5), width = 1 + int(dx / step + 0.5).
    const Points points = {{0.2, 3.0, 1.0}, {0.44, 3.0, 2.0}, {0.45, 3.0, 4.0}, {0.95, 3.0, 8.0}};
    const DemGrid grid = grid_of(points, 0.5, Lattice::node);
    EXPECT_EQ(grid.geometry.nx, 3);  // 1 + int(1.5 + 0.5)
    EXPECT_EQ(grid.geometry.ny, 1);
    EXPECT_NEAR(grid.geometry.origin_m.x(), -0.05, 1e-15);
    EXPECT_NEAR(grid.geometry.center_m({0, 0}).x(), 0.2, 1e-15);
    const auto mean = dem_of(points, grid, Reduce::mean);
    EXPECT_EQ(mean.at(0, 0), 1.5F);
    EXPECT_EQ(mean.at(1, 0), 4.0F);
    EXPECT_EQ(mean.at(2, 0), 8.0F);
}

/// Simulates three threads; the last piece runs first.
class Backward final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = count - 1; index >= 0; --index) work(index);
    }
    [[nodiscard]] int threads() const noexcept override { return 3; }
};

TEST(Dem, BoundsOfManyPointsAreTheSameForAnyNumberOfThreads) {
    Rng rng(7);
    Points points;
    for (int i = 0; i < 70'000; ++i) {
        points.emplace_back(rng.uniform(-3.0, 8.0), rng.uniform(-1.0, 1.0), rng.normal());
        if (i % 1000 == 7) points.back().y() = kNan;
    }
    CloudBounds alone;
    for (const Eigen::Vector3d& p_m : points) alone.add(std::span(&p_m, 1));
    Backward threads;
    CloudBounds together;
    together.add(points, threads);
    EXPECT_EQ(together.points(), alone.points());
    EXPECT_EQ(together.skipped(), 70);
    const DemGrid a = alone.grid(0.01, Lattice::node).value();
    const DemGrid b = together.grid(0.01, Lattice::node).value();
    EXPECT_EQ(a.geometry.nx, b.geometry.nx);
    EXPECT_EQ(a.geometry.ny, b.geometry.ny);
    EXPECT_EQ(a.geometry.origin_m, b.geometry.origin_m);
    for (const Reduce reduce : {Reduce::max, Reduce::mean}) {
        DemBuilder one(a, reduce);
        one.add(points);
        DemBuilder many(a, reduce);
        many.add(points, threads);
        const auto first = one.heights_m();
        const auto second = many.heights_m();
        EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(float)), 0);
    }
}

TEST(Dem, EveryCellIsWhatAMapOfListsHolds) {
    Rng rng(1);
    for (int trial = 0; trial < 40; ++trial) {
        const double resolution_m = trial % 2 == 0 ? 0.1 : rng.uniform(0.02, 0.3);
        const Lattice lattice = trial % 4 < 2 ? Lattice::cell : Lattice::node;
        Points points;
        for (int i = 0; i < 400; ++i) {
            // Multiples of the resolution in half the trials: borders and centres are hit.
            const auto xy = [&] {
                return trial % 2 == 0 ? 0.1 * (static_cast<double>(rng.below(20)) - 7.0)
                                      : rng.uniform(-1.0, 1.0);
            };
            points.emplace_back(xy(), xy(), rng.normal());
        }
        points.emplace_back(0.0, kNan, 1.0);
        double x_min = 1e9, y_min = 1e9;
        for (const auto& p : points) {
            if (!p.allFinite()) continue;
            x_min = std::min(x_min, p.x());
            y_min = std::min(y_min, p.y());
        }
        std::map<std::pair<int, int>, std::vector<double>> cells;
        for (const auto& p : points) {
            if (!p.allFinite()) continue;
            const auto index = [&](double value, double low) {
                return lattice == Lattice::node
                           ? static_cast<int>(std::floor((value - low) / resolution_m + 0.5))
                           : static_cast<int>(std::floor(value / resolution_m) -
                                              std::floor(low / resolution_m));
            };
            cells[{index(p.x(), x_min), index(p.y(), y_min)}].push_back(p.z());
        }
        const DemGrid grid = grid_of(points, resolution_m, lattice);
        for (const Reduce reduce : {Reduce::max, Reduce::mean, Reduce::min}) {
            // In two pieces: nothing may depend on how the points arrive.
            DemBuilder builder(grid, reduce);
            builder.add(std::span(points).first(150));
            builder.add(std::span(points).subspan(150));
            const auto heights = builder.heights_m();
            Backward threads;
            DemBuilder threaded(grid, reduce);
            threaded.add(Points(points.rbegin(), points.rend()), threads);
            const auto same = threaded.heights_m();
            ASSERT_EQ(std::memcmp(same.data(), heights.data(), heights.size() * sizeof(float)), 0);
            std::size_t known = 0;
            for (int iy = 0; iy < heights.height(); ++iy) {
                for (int ix = 0; ix < heights.width(); ++ix) {
                    const auto cell = cells.find({ix, iy});
                    ASSERT_EQ(std::isnan(heights.at(ix, iy)), cell == cells.end()) << trial;
                    if (cell == cells.end()) continue;
                    ++known;
                    const auto& z = cell->second;
                    double sum = 0.0;
                    for (const double value : z) sum += value;
                    const double expected =
                        reduce == Reduce::max   ? *std::max_element(z.begin(), z.end())
                        : reduce == Reduce::min ? *std::min_element(z.begin(), z.end())
                                                : sum / static_cast<double>(z.size());
                    if (reduce == Reduce::mean) {
                        // Half a step of the sums, half a step of the float.
                        ASSERT_NEAR(heights.at(ix, iy), expected, 0.6e-7 + 1.2e-7) << trial;
                    } else {
                        ASSERT_EQ(heights.at(ix, iy), static_cast<float>(expected)) << trial;
                    }
                }
            }
            ASSERT_EQ(known, cells.size()) << "a point fell outside the grid";
        }
    }
}

TEST(Dem, OnePointAndPointsThatAreNone) {
    const DemGrid grid = grid_of({{7.0, -3.0, 2.0}, {kNan, 0.0, 0.0}}, 0.025, Lattice::cell);
    EXPECT_EQ(grid.geometry.nx * grid.geometry.ny, 1);
    EXPECT_EQ(dem_of({{7.0, -3.0, 2.0}}, grid, Reduce::mean).at(0, 0), 2.0F);

    CloudBounds none;
    none.add(Points{{kNan, 0.0, 0.0}, {0.0, 0.0, kNan}});
    EXPECT_EQ(none.skipped(), 2);
    EXPECT_EQ(none.points(), 0);
    const auto grid_of_none = none.grid(0.1, Lattice::cell);
    ASSERT_FALSE(grid_of_none.ok());
    EXPECT_NE(grid_of_none.error().message.find("no point"), std::string::npos);
}

TEST(Dem, HeightsThatAreNoneAreLeftOutAndCounted) {
    const Points points = {
        {0, 0, 0.1}, {0, 0, 1e12}, {0, 0, -3.4e38}, {0.1, 0, 1e5}, {0.1, 0, 100001}};
    CloudBounds bounds;
    bounds.add(points);
    EXPECT_EQ(bounds.points(), 2);
    EXPECT_EQ(bounds.skipped(), 3);
    const DemGrid grid = grid_of(points, 0.1, Lattice::cell);
    EXPECT_EQ(dem_of(points, grid, Reduce::max).at(0, 0), 0.1F);
    EXPECT_EQ(dem_of(points, grid, Reduce::max).at(1, 0), 1e5F);
    EXPECT_EQ(dem_of(points, grid, Reduce::min).at(0, 0), 0.1F);
}

TEST(Dem, AStrayPointIsRefusedInWords) {
    for (const Lattice lattice : {Lattice::cell, Lattice::node}) {
        for (const double far_m : {1e5, 1e18, 1e300}) {
            CloudBounds bounds;
            bounds.add(Points{{0.0, 0.0, 0.0}, {far_m, -far_m, 0.0}});
            const auto grid = bounds.grid(0.025, lattice);
            ASSERT_FALSE(grid.ok()) << far_m;
            EXPECT_NE(grid.error().message.find("choose larger cells"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace surefoot::eval
