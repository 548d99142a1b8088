// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/planar_patches.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/geometry/plane_fit.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::TestMap;

constexpr double kDegPerRad = 1.0 / kRadPerDeg;

PatchMap patches_of(const TestMap& map) {
    PatchMap out;
    PatchFinder(PatchConfig{}).find(map.terrain(), out);
    return out;
}

/// The patch at a point of the world.
std::int32_t at(const TestMap& map, const PatchMap& patches, double x_m, double y_m) {
    const Eigen::Vector2d p_m = map.to_map({x_m, y_m});
    const auto cell = map.geometry.cell_at(p_m.x(), p_m.y());
    return cell ? patches.of_cell.at(cell->ix, cell->iy) : PatchMap::kNone;
}

TEST(PlanarPatches, ALeaningPlaneIsOnePatchWithItsSlopeAndNoise) {
    for (const double yaw_deg : {0.0, 33.0, 90.0}) {
        for (const double sigma_m : {0.0, 0.004, 0.010}) {
            TestMap map([](double x_m, double) { return 0.3 + 0.1 * x_m; },
                        yaw_deg * kRadPerDeg,
                        {0.006, 0.011});
            if (sigma_m > 0.0) map.add_noise(sigma_m, 21);
            const PatchMap patches = patches_of(map);
            const auto where = ::testing::Message() << yaw_deg << " deg, " << sigma_m << " m";
            ASSERT_EQ(patches.patches.size(), 1U) << where;
            const PlanarPatch& patch = patches.patches[0];
            EXPECT_GT(patch.cells, 0.99 * map.geometry.nx * map.geometry.ny) << where;
            const double slope_rad = std::atan(0.1);
            EXPECT_NEAR(patch.slope_rad(), slope_rad, 1e-4 + 4.0 * patch.slope_sigma_rad) << where;
            const Eigen::Vector2d up = map.to_map({1.0, 0.0}) - map.to_map({0.0, 0.0});
            EXPECT_GT(patch.gradient.normalized().dot(up), 0.999) << where;
            EXPECT_NEAR(patch.rms_m, sigma_m, 0.1 * sigma_m + 1e-4) << where;
            EXPECT_NEAR(patch.width_m, 5.0, 0.05) << where;
        }
    }
}

// Readers exclude heights beyond kMaxHeight_m. If they occur, the finder must not crash.
TEST(PlanarPatches, HeightsOfAnyMagnitudeLeaveTheOthersAlone) {
    for (const float bad_m : {9e4F, -1e10F, 1e12F, std::numeric_limits<float>::lowest()}) {
        TestMap map([](double, double) { return 0.0; }, 0.0, {0.0, 0.0});
        map.height_m.at(10, 10) = bad_m;
        const PatchMap patches = patches_of(map);
        EXPECT_FALSE(patches.patches.empty()) << bad_m;
        EXPECT_EQ(patches.of_cell.at(10, 10), PatchMap::kNone) << bad_m;
        EXPECT_NE(patches.of_cell.at(60, 60), PatchMap::kNone) << bad_m;
    }
}

// The sums over blocks equal the sums over all cells: the plane equals total least squares, whose
// residuals lie along the normal.
TEST(PlanarPatches, ThePlaneIsThatOfItsCells) {
    TestMap map([](double x_m, double y_m) { return 0.02 * x_m - 0.03 * y_m; }, 0.4, {0.0, 0.0});
    map.add_noise(0.003, 22);
    const PatchMap patches = patches_of(map);
    ASSERT_EQ(patches.patches.size(), 1U);
    std::vector<Eigen::Vector3d> points_m;
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            if (patches.of_cell.at(ix, iy) != 0) continue;
            const Eigen::Vector2d p_m = map.geometry.center_m({ix, iy});
            points_m.emplace_back(p_m.x(), p_m.y(), static_cast<double>(map.height_m.at(ix, iy)));
        }
    }
    const auto fit = geometry::fit_plane(points_m);
    ASSERT_TRUE(fit);
    const PlanarPatch& patch = patches.patches[0];
    for (const double x_m : {-2.0, 2.0}) {
        const Eigen::Vector2d p_m(x_m, 0.5 * x_m);
        const Eigen::Vector3d p(p_m.x(), p_m.y(), patch.height_m(p_m));
        EXPECT_LT(std::abs(fit->plane.signed_distance_m(p)), 1e-4);
    }
}

TEST(PlanarPatches, ARampBeginsWhereItLeavesTheFloorByTheTolerance) {
    TestMap map([](double x_m, double) { return x_m < 0.0 ? 0.0 : x_m / 12.0; },
                20.0 * kRadPerDeg,
                {0.0, 0.0});
    map.add_noise(0.003, 23);
    const PatchMap patches = patches_of(map);
    ASSERT_EQ(patches.patches.size(), 2U);
    const std::int32_t floor = at(map, patches, -0.5, 0.0);
    const std::int32_t ramp = at(map, patches, 0.5, 0.0);
    ASSERT_NE(floor, ramp);
    const PlanarPatch& leaning = patches.patches[static_cast<std::size_t>(ramp)];
    EXPECT_NEAR(leaning.slope_rad() * kDegPerRad, 4.76, 0.1);
    EXPECT_NEAR(
        patches.patches[static_cast<std::size_t>(floor)].slope_rad() * kDegPerRad, 0.0, 0.1);
    // The better plane wins, except where noise of 3 mm decides: 3 sigma are 0.11 m of the ramp.
    for (double y_m = -1.0; y_m <= 1.0; y_m += 0.1) {
        EXPECT_EQ(at(map, patches, -0.15, y_m), floor) << y_m;
        EXPECT_EQ(at(map, patches, 0.25, y_m), ramp) << y_m;
    }
}

// Regions that begin at the foot of a ramp lean until their border is correct. Only then the pieces
// of the floor lie on one plane.
TEST(PlanarPatches, AFloorAroundThingsIsOnePatch) {
    const auto ground = [](double x_m, double y_m) {
        if (std::abs(x_m + 1.0) < 0.4 && y_m > 1.2 && y_m < 1.9) return 0.72;
        if (x_m > -0.6 && x_m < 0.2 && y_m < -1.2 && y_m > -1.9) return -0.3;
        return x_m > -1.9 && x_m < -1.0 && y_m < -1.4 ? 0.08 * (x_m + 1.9) : 0.0;
    };
    const TestMap map(ground, 20.0 * kRadPerDeg, {0.013, 0.007});
    const PatchMap patches = patches_of(map);
    EXPECT_EQ(patches.patches.size(), 4U);
    const std::int32_t floor = at(map, patches, -1.5, 0.0);
    ASSERT_NE(floor, PatchMap::kNone);
    for (const double x_m : {-1.5, -0.5, 0.5, 1.5})
        for (const double y_m : {-1.0, 0.0, 1.0}) EXPECT_EQ(at(map, patches, x_m, y_m), floor);
}

TEST(PlanarPatches, EachTreadIsAPatchAtAnyYaw) {
    const testing::TestFlight flight{.steps = 5, .riser_m = 0.17, .going_m = 0.28};
    for (const double yaw_deg : {0.0, 20.0, 45.0, 70.0}) {
        TestMap map([&](double x_m, double y_m) { return flight.at(x_m, y_m); },
                    yaw_deg * kRadPerDeg,
                    {0.004, 0.009});
        map.add_noise(0.006, 24);
        const PatchMap patches = patches_of(map);
        EXPECT_EQ(patches.patches.size(), 6U) << yaw_deg;  // floor, four treads, landing
        std::int32_t last = at(map, patches, -0.14, 0.0);
        for (int k = 0; k < 5; ++k) {
            const std::int32_t next = at(map, patches, 0.28 * k + 0.14, 0.0);
            ASSERT_NE(next, PatchMap::kNone) << yaw_deg << ' ' << k;
            EXPECT_NE(next, last) << yaw_deg << ' ' << k;
            const PlanarPatch& patch = patches.patches[static_cast<std::size_t>(next)];
            EXPECT_NEAR(patch.middle_m.z(), 0.17 * (k + 1), 0.004) << yaw_deg << ' ' << k;
            last = next;
        }
    }
}

TEST(PlanarPatches, CellsThatAreKnownBadlyCountLess) {
    // Every second cell has a sigma of 20 mm and lies 15 mm too high.
    TestMap map([](double, double) { return 0.0; }, 0.0, {0.0, 0.0});
    for (int iy = 0; iy < map.geometry.ny; ++iy) {
        for (int ix = 0; ix < map.geometry.nx; ++ix) {
            const bool bad = (ix + iy) % 2 == 0;
            map.height_m.at(ix, iy) = bad ? 0.015F : 0.0F;
            map.var_m2.at(ix, iy) = bad ? 4e-4F : 4e-6F;
        }
    }
    const PatchMap patches = patches_of(map);
    ASSERT_EQ(patches.patches.size(), 1U);
    // Weights 1 / (400 + 25) and 1 / (4 + 25) mm-2 give 0.96 mm; equal weights would give 7.5 mm.
    EXPECT_NEAR(patches.patches[0].middle_m.z(), 0.00096, 1e-4);
}

TEST(PlanarPatches, NoPlaneIsNoPatch) {
    TestMap noise([](double, double) { return 0.0; }, 0.0, {0.0, 0.0});
    noise.add_noise(0.3, 25);
    noise.var_m2.fill(1e-6F);
    EXPECT_TRUE(patches_of(noise).patches.empty());
    TestMap unknown([](double, double) { return std::nan(""); }, 0.0, {0.0, 0.0});
    unknown.height_m.fill(std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(patches_of(unknown).patches.empty());
    TestMap one([](double, double) { return 0.0; }, 0.0, {0.0, 0.0});
    one.height_m.fill(std::numeric_limits<float>::quiet_NaN());
    one.height_m.at(17, 31) = 0.5F;
    const PatchMap of_one = patches_of(one);
    EXPECT_TRUE(of_one.patches.empty());
    EXPECT_EQ(of_one.of_cell.at(17, 31), PatchMap::kNone);
}

TEST(PlanarPatches, CellsOfAnySizeFindTheSamePlanes) {
    const testing::TestFlight flight{.steps = 3, .going_m = 0.30};
    for (const double cell_m : {0.005, 0.01, 0.02, 0.05}) {
        const TestMap map([&](double x_m, double y_m) { return flight.at(x_m, y_m); },
                          0.0,
                          {0.0, 0.0},
                          cell_m,
                          2.0);
        const PatchMap patches = patches_of(map);
        EXPECT_EQ(patches.patches.size(), 4U) << cell_m;
    }
}

TEST(PlanarPatches, TheSameMapGivesTheSamePatchesAgain) {
    const testing::TestFlight flight;
    TestMap map([&](double x_m, double y_m) { return flight.at(x_m, y_m); }, 0.3, {0.0, 0.0});
    map.add_noise(0.01, 26);
    PatchFinder finder(PatchConfig{});
    PatchMap first, again;
    finder.find(map.terrain(), first);
    const TestMap other([](double x_m, double) { return 0.2 * x_m; }, 0.0, {0.0, 0.0}, 0.025, 3.0);
    finder.find(other.terrain(), again);
    finder.find(map.terrain(), again);
    ASSERT_EQ(first.patches.size(), again.patches.size());
    for (std::size_t i = 0; i < first.of_cell.size(); ++i)
        ASSERT_EQ(first.of_cell.data()[i], again.of_cell.data()[i]) << i;
}

}  // namespace
}  // namespace surefoot::stairs
