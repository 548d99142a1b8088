// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/map_region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "surefoot/core/unknown.hpp"
#include "surefoot/grid/moving_window.hpp"

namespace surefoot::grid {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// All cells are known. The height encodes the cell: 100 x + y in lattice cells.
MapRegion known_region(const LatticeBox& box) {
    MapRegion region;
    region.box = box;
    region.height_m = Image<float>(box.nx, box.ny);
    for (int iy = 0; iy < box.ny; ++iy) {
        for (int ix = 0; ix < box.nx; ++ix) {
            region.height_m.at(ix, iy) =
                static_cast<float>(100 * (box.first_ix + ix) + box.first_iy + iy);
        }
    }
    region.height_var_m2 = Image<float>(box.nx, box.ny, 1e-4F);
    region.count = Image<std::uint32_t>(box.nx, box.ny, 3);
    region.seen_ns = Image<std::int64_t>(box.nx, box.ny, 5);
    region.horizontal_drift_m = Image<float>(box.nx, box.ny, 0.0F);
    region.highest_m = Image<float>(box.nx, box.ny, 0.1F);
    region.lowest_m = Image<float>(box.nx, box.ny, 0.0F);
    region.clearance_m = Image<float>(box.nx, box.ny, kNanF);
    region.confidence = Image<float>(box.nx, box.ny, 0.5F);
    region.density_ratio = Image<float>(box.nx, box.ny, kNanF);
    return region;
}

TEST(MapRegion, LiesOnTheLatticeOfTheWindowItComesFrom) {
    MovingWindow window(1.0, 0.025);
    for (const double x_m : {0.0, 0.613, -17.37, 98765.432, -1e6}) {
        window.center_on(x_m, -0.3 * x_m);
        const LatticeBox box = box_of(window.geometry());
        EXPECT_EQ(box.first_ix, window.first_ix());
        EXPECT_EQ(box.first_iy, window.first_iy());
        MapRegion region = known_region(box);
        region.height_m.fill(0.0F);
        EXPECT_EQ(region.problem(), std::nullopt);
        EXPECT_EQ(region.geometry().origin_m, window.geometry().origin_m);
    }
}

TEST(MapRegion, ACutHoldsTheSamePlacesAndNothingElse) {
    const MapRegion region = known_region({-2, 5, 4, 3});
    for (const LatticeBox& box : {LatticeBox{-2, 5, 4, 3},
                                  LatticeBox{-1, 6, 2, 1},
                                  LatticeBox{-5, 3, 9, 8},
                                  LatticeBox{0, 7, 5, 5},
                                  LatticeBox{2, 5, 3, 3},
                                  LatticeBox{-900, 5, 7, 3},
                                  LatticeBox{-2, 1'000'000'000'000, 7, 3}}) {
        const MapRegion piece = cut(region, box);
        ASSERT_EQ(piece.problem(), std::nullopt);
        EXPECT_EQ(piece.box, box);
        for (int iy = 0; iy < box.ny; ++iy) {
            for (int ix = 0; ix < box.nx; ++ix) {
                const std::int64_t x = box.first_ix + ix;
                const std::int64_t y = box.first_iy + iy;
                const bool inside = x >= -2 && x < 2 && y >= 5 && y < 8;
                const float height_m = piece.height_m.at(ix, iy);
                ASSERT_EQ(std::isnan(height_m), !inside) << x << " " << y;
                ASSERT_EQ(piece.count.at(ix, iy), inside ? 3U : 0U);
                if (inside) {
                    ASSERT_EQ(height_m, static_cast<float>(100 * x + y));
                }
            }
        }
    }
}

TEST(MapRegion, BoxesAreUnitedAndTooLargeOnesAreNone) {
    EXPECT_EQ(united({-2, 5, 4, 3}, {1, 1, 2, 2}), (LatticeBox{-2, 1, 5, 7}));
    EXPECT_EQ(united({0, 0, 9, 9}, {2, 3, 1, 1}), (LatticeBox{0, 0, 9, 9}));
    EXPECT_TRUE(united({-kMaxLatticeIndex, 0, 4, 3}, {kMaxLatticeIndex, 0, 1, 1}).problem());
    EXPECT_FALSE((LatticeBox{0, 0, kMaxRegionSide, 1024}).problem());
    EXPECT_TRUE((LatticeBox{0, 0, kMaxRegionSide, 1025}).problem());
    EXPECT_TRUE((LatticeBox{0, 0, kMaxRegionSide + 1, 1}).problem());
    EXPECT_TRUE((LatticeBox{0, 0, 0, 1}).problem());
    EXPECT_TRUE((LatticeBox{std::numeric_limits<std::int64_t>::min(), 0, 1, 1}).problem());
}

TEST(MapRegion, EveryNumberThatCannotBeIsNamed) {
    struct Case {
        const char* words;
        std::function<void(MapRegion&)> damage;
    };
    const Case cases[] = {
        {"cells of", [](MapRegion& r) { r.resolution_m = 0.0; }},
        {"cells of", [](MapRegion& r) { r.resolution_m = std::nan(""); }},
        {"name", [](MapRegion& r) { r.frame = ""; }},
        {"name", [](MapRegion& r) { r.frame = "o\n"; }},
        {"name", [](MapRegion& r) { r.frame.assign(kMaxFrameName + 1, 'x'); }},
        {"base_link", [](MapRegion& r) { r.T_frame_body.translation_m.x() = kNanF; }},
        {"base_link", [](MapRegion& r) { r.T_frame_body.rotation.w() = 2.0; }},
        {"layer drift", [](MapRegion& r) { r.horizontal_drift_m = Image<float>(2, 3, 0.0F); }},
        {"(1, 1) has elevation inf", [](MapRegion& r) { r.height_m.at(1, 1) = kInf; }},
        {"(1, 1) has variance 0", [](MapRegion& r) { r.height_var_m2.at(1, 1) = 0.0F; }},
        {"(1, 1) has variance nan", [](MapRegion& r) { r.height_var_m2.at(1, 1) = kNanF; }},
        {"(0, 1) has drift nan", [](MapRegion& r) { r.horizontal_drift_m.at(0, 1) = kNanF; }},
        {"(0, 1) has drift -1", [](MapRegion& r) { r.horizontal_drift_m.at(0, 1) = -1.0F; }},
        {"(0, 0) has highest nan", [](MapRegion& r) { r.highest_m.at(0, 0) = kNanF; }},
        {"(0, 0) has lowest -inf", [](MapRegion& r) { r.lowest_m.at(0, 0) = -kInf; }},
        {"(0, 0) has clearance inf", [](MapRegion& r) { r.clearance_m.at(0, 0) = kInf; }},
        {"(0, 0) has confidence 1.5", [](MapRegion& r) { r.confidence.at(0, 0) = 1.5F; }},
        {"(0, 0) has density_ratio -1", [](MapRegion& r) { r.density_ratio.at(0, 0) = -1.0F; }},
        {"(1, 0) has count 0", [](MapRegion& r) { r.count.at(1, 0) = 0; }},
        {"(1, 0) has variance 0.0001 where the height is unknown",
         [](MapRegion& r) { r.height_m.at(1, 0) = kNanF; }},
    };
    for (const Case& c : cases) {
        MapRegion region = known_region({0, 0, 2, 2});
        c.damage(region);
        const auto problem = region.problem();
        ASSERT_TRUE(problem) << c.words;
        EXPECT_NE(problem->find(c.words), std::string::npos) << *problem;
    }
}

}  // namespace
}  // namespace surefoot::grid
