// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/surface_dem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr double kResolution_m = 0.025;

/// Floor, then four steps down of 0.17 m by 0.28 m.
double stairs_z_m(double x_m) {
    constexpr double kFirst_m = 0.6;
    if (x_m < kFirst_m) return 0.0;
    return -0.17 * std::min(4.0, std::floor((x_m - kFirst_m) / 0.28) + 1.0);
}

/// Range at which a ray meets the stairs, found in small steps.
double range_m(const Vector3d& from_m, const Vector3d& direction) {
    constexpr double kStep_m = 0.002;
    for (double r_m = 0.3; r_m < 6.0; r_m += kStep_m) {
        const Vector3d p_m = from_m + r_m * direction;
        if (p_m.z() <= stairs_z_m(p_m.x())) return r_m;
    }
    return std::numeric_limits<double>::infinity();
}

/// An organised cloud of a depth camera 0.7 m above the floor: noise along the ray, and points in
/// flight between a nosing and the surface behind it, with a range between the two.
Points depth_camera(std::uint64_t seed) {
    constexpr int kColumns = 180;
    constexpr int kRows = 260;
    constexpr double kPixel_rad = 0.0025;
    Rng rng(seed);
    const Vector3d camera_m(-1.0, 0.0, 0.7);
    Points points_m;
    for (int column = 0; column < kColumns; ++column) {
        const double yaw = kPixel_rad * (column - kColumns / 2);
        std::vector<double> ranges_m;
        std::vector<Vector3d> rays;
        for (int row = 0; row < kRows; ++row) {
            const double pitch = -0.15 - kPixel_rad * row;
            rays.emplace_back(
                std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
            ranges_m.push_back(range_m(camera_m, rays.back()));
        }
        for (std::size_t row = 1; row < rays.size(); ++row) {
            double r_m = ranges_m[row];
            if (!std::isfinite(r_m) || !std::isfinite(ranges_m[row - 1])) continue;
            // Half of the pixels just behind a jump are in flight: between the two surfaces.
            const std::size_t first = row - std::min<std::size_t>(row, 2);
            for (std::size_t before = first; before < row; ++before) {
                const double jump_m = ranges_m[before] - ranges_m[before + 1];
                if (!(std::abs(jump_m) > 0.05) || rng.below(2) == 0) continue;
                r_m += rng.uniform(0.05, 0.95) * jump_m;
                break;
            }
            points_m.push_back(camera_m + (r_m + 0.003 * rng.normal()) * rays[row]);
        }
    }
    // Outliers high above all surfaces, some of them alone in their cells.
    for (int i = 0; i < 200; ++i)
        points_m.emplace_back(
            rng.uniform(0.0, 2.0), rng.uniform(-0.4, 0.4), rng.uniform(-0.5, 1.0));
    return points_m;
}

eval::DemGrid grid_of(const Points& points_m) {
    eval::CloudBounds bounds;
    bounds.add(points_m);
    return *bounds.grid(kResolution_m, eval::Lattice::cell);
}

SurfaceDem dem_of(const Points& points_m,
                  const SurfaceRules& rules = {},
                  Executor& executor = serial()) {
    return *surface_dem(
        grid_of(points_m), rules, [&](const auto& take) { return take(points_m); }, executor);
}

struct Check {
    int known = 0;
    int wrong = 0;  ///< off by more than 25 mm, more than a cell away from every riser
};
Check check(const eval::DemGrid& grid, const grid::Layer& height_m) {
    constexpr double kTolerance_m = 0.025;
    Check result;
    for (int iy = 0; iy < grid.geometry.ny; ++iy) {
        for (int ix = 0; ix < grid.geometry.nx; ++ix) {
            const auto z_m = static_cast<double>(height_m.at(ix, iy));
            if (std::isnan(z_m)) continue;
            ++result.known;
            const double x_m = grid.geometry.center_m({ix, iy}).x();
            const double beside_m = 1.6 * kResolution_m;
            const double truth_m = stairs_z_m(x_m);
            if (stairs_z_m(x_m - beside_m) != truth_m || stairs_z_m(x_m + beside_m) != truth_m)
                continue;
            result.wrong += std::abs(z_m - truth_m) > kTolerance_m ? 1 : 0;
        }
    }
    return result;
}

TEST(SurfaceDem, PixelsInFlightAreNoGround) {
    const Points points_m = depth_camera(1);
    const eval::DemGrid grid = grid_of(points_m);
    eval::DemBuilder highest(grid, eval::Reduce::max);
    highest.add(points_m);
    const Check by_maximum = check(grid, highest.heights_m());
    const SurfaceDem dem = dem_of(points_m);
    const Check by_surface = check(grid, dem.height_m);
    EXPECT_GT(by_maximum.wrong, by_maximum.known / 40);
    EXPECT_LT(by_surface.wrong, by_surface.known / 100);
    EXPECT_LT(by_surface.wrong, by_maximum.wrong / 6);
    EXPECT_GT(by_surface.known, by_maximum.known * 8 / 10);
    EXPECT_GT(dem.unsupported_cells, 0);
}

TEST(SurfaceDem, WhatHangsIsClearanceAndNoGround) {
    Points points_m = depth_camera(2);
    Rng rng(3);
    for (int i = 0; i < 3000; ++i)  // a beam across, 1.9 m up
        points_m.emplace_back(
            rng.uniform(0.1, 0.3), rng.uniform(-0.2, 0.2), rng.uniform(1.9, 1.92));
    const SurfaceDem dem = dem_of(points_m);
    const Check found = check(grid_of(points_m), dem.height_m);
    EXPECT_LT(found.wrong, found.known / 100);
    EXPECT_GT(dem.overhung_cells, 100);
    const auto under = grid_of(points_m).geometry.cell_at(0.2, 0.0);
    ASSERT_TRUE(under);
    EXPECT_NEAR(dem.clearance_m.at(under->ix, under->iy), 1.9F, 0.03F);
    // Without points below an overhang, only a height limit shows that the overhang is not the
    // ground.
    Points beam_m;
    for (const Vector3d& p_m : points_m)
        if (p_m.z() > 1.8 || p_m.x() < 0.05 || p_m.x() > 0.35) beam_m.push_back(p_m);
    EXPECT_GT(dem_of(beam_m).height_m.at(under->ix, under->iy), 1.8F);
    const auto rules = surface_rules(std::nullopt, 1.5);
    ASSERT_TRUE(rules);
    const SurfaceDem cut = dem_of(beam_m, *rules);
    EXPECT_TRUE(std::isnan(cut.height_m.at(under->ix, under->iy)));
    EXPECT_GE(cut.cut_points, 3000);
}

TEST(SurfaceDem, SparseCloudsTakeTheirNeighboursAsWitnesses) {
    // One point per cell, as in the cloud of a map, on a ramp of 30 deg.
    Points points_m;
    for (int iy = 0; iy < 40; ++iy) {
        for (int ix = 0; ix < 40; ++ix) {
            const double x_m = kResolution_m * (ix + 0.5);
            points_m.emplace_back(x_m, kResolution_m * (iy + 0.5), x_m * std::tan(M_PI / 6.0));
        }
    }
    const SurfaceDem all = dem_of(points_m);
    EXPECT_EQ(all.unsupported_cells, 0);
    points_m[820].z() += 0.2;
    const SurfaceDem dem = dem_of(points_m);
    EXPECT_EQ(dem.unsupported_cells, 1);
    EXPECT_TRUE(std::isnan(dem.height_m.data()[820]));
}

TEST(SurfaceDem, MirrorImagesBelowAFloorAreNoGround) {
    Points points_m;
    Rng rng(4);
    for (int i = 0; i < 40000; ++i)
        points_m.emplace_back(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), 0.003 * rng.normal());
    for (int i = 0; i < 1000; ++i)
        points_m.emplace_back(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), -1.0);
    const SurfaceDem dem = dem_of(points_m);
    for (std::size_t i = 0; i < dem.height_m.size(); ++i)
        EXPECT_GT(dem.height_m.data()[i], -0.02F) << i;
}

TEST(SurfaceDem, SameBytesForAnyOrderAndNumberOfThreads) {
    Points points_m = depth_camera(5);
    const SurfaceDem one = dem_of(points_m);
    std::reverse(points_m.begin(), points_m.end());
    Threads threads(3);
    const SurfaceDem other = dem_of(points_m, {}, threads);
    for (std::size_t i = 0; i < one.height_m.size(); ++i) {
        const float a = one.height_m.data()[i];
        const float b = other.height_m.data()[i];
        EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i;
    }
}

TEST(SurfaceDem, CrossedHeightsAreAUsageError) {
    const auto crossed = surface_rules(1.0, 0.5);
    ASSERT_FALSE(crossed);
    EXPECT_NE(crossed.error().message.find("--min-height 1 must be below --max-height 0.5"),
              std::string::npos);
}

}  // namespace
}  // namespace surefoot::app
