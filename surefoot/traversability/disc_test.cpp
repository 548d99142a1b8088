// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/disc.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace surefoot::traversability {
namespace {

std::size_t cells_in(double radius_m, double resolution_m) {
    Disc disc;
    disc.build(radius_m, resolution_m, 1000);
    return disc.cells.size();
}

TEST(Disc, ShorterThanACellIsTheCentreAlone) {
    EXPECT_EQ(cells_in(0.024, 0.025), 1U);
    EXPECT_EQ(Disc::reach_of(0.024, 0.025), 0);
}

TEST(Disc, CellsOnTheRimAreInWhateverTheRoundingOfTheQuotient) {
    EXPECT_EQ(cells_in(0.025, 0.025), 5U);
    EXPECT_EQ(cells_in(0.05, 0.025), 13U);
    EXPECT_EQ(cells_in(0.075, 0.025), 29U);  // 0.075 / 0.025 rounds below 3
    EXPECT_EQ(cells_in(0.1, 0.025), 49U);
    EXPECT_EQ(cells_in(0.3, 0.1), 29U);
    EXPECT_EQ(Disc::reach_of(0.075, 0.025), 3);
}

TEST(Disc, IsSymmetricAndCarriesItsOffsets) {
    constexpr int kStride = 50;
    Disc disc;
    disc.build(0.06, 0.025, kStride);
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (const DiscCell& cell : disc.cells) {
        sum_x += cell.x_m;
        sum_y += cell.y_m;
        const double dx = std::round(cell.x_m / 0.025);
        const double dy = std::round(cell.y_m / 0.025);
        EXPECT_EQ(cell.offset, static_cast<std::ptrdiff_t>(dy * kStride + dx));
    }
    EXPECT_EQ(disc.cells.size(), 21U);
    EXPECT_NEAR(sum_x, 0.0, 1e-15);
    EXPECT_NEAR(sum_y, 0.0, 1e-15);
}

TEST(CellRect, ClippingKeepsThePartWithinTheGrid) {
    EXPECT_EQ((CellRect{-2, 3, 5, 10}.clipped(10, 8)), (CellRect{0, 3, 3, 5}));
    EXPECT_TRUE((CellRect{20, 0, 5, 5}.clipped(10, 8).empty()));
    EXPECT_TRUE((CellRect{0, 0, 5, 5}.clipped(0, 0).empty()));
}

TEST(PaddedLayer, IsUnknownAroundAndWhereValuesAreNotFinite) {
    const float infinity = std::numeric_limits<float>::infinity();
    grid::Layer source(2, 1);
    source.at(0, 0) = 1.5F;
    source.at(1, 0) = -infinity;
    PaddedLayer layer;
    layer.reset({0, 0, 2, 1}, 2);
    layer.load(std::as_const(source).view(), {0, 0, 2, 1});
    for (int iy = -2; iy <= 2; ++iy) {
        for (int ix = -2; ix <= 3; ++ix) {
            const float value = *layer.cell(ix, iy);
            if (ix == 0 && iy == 0) {
                EXPECT_EQ(value, 1.5F);
            } else {
                EXPECT_TRUE(std::isnan(value)) << ix << ' ' << iy;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::traversability
