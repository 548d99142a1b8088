// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/layer_sheet.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

grid::GridGeometry grid_of(int nx, int ny) {
    return {0.1, nx, ny, {-1.0, -1.0}};
}

LayerStyle grey() {
    LayerStyle style;
    style.map = ColorMap::grey;
    style.range = ValueRange{0.0, 1.0};
    return style;
}

int count(const Picture& picture, Rgb8 color) {
    int found = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) found += picture.data()[i] == color ? 1 : 0;
    return found;
}

Overlays nothing_over_it() {
    Overlays overlays;
    overlays.scale_bar = false;
    return overlays;
}

TEST(LayerSheet, ShowsWhatAnyLayerKnowsAndNoMore) {
    // A far larger map than what is known of it: the cell is as large as in a small map.
    const auto area_of_one = [](int side) {
        grid::Layer known(side, side, kNanF);
        known.at(side / 2, side / 2) = 0.5F;
        const Picture sheet = render_layer_sheet(
            grid_of(side, side), {{known, grey()}}, 1, {"t", ""}, nothing_over_it());
        return count(sheet, color_at(ColorMap::grey, 0.5));
    };
    EXPECT_GT(area_of_one(13), 400);
    // The bar beside it has that colour too, in one row of pixels.
    EXPECT_EQ(area_of_one(200), area_of_one(13));
}

TEST(LayerSheet, ForwardIsUpAndLeftIsLeft) {
    constexpr int kSide = 11;
    const auto centre_of_ink = [&](int ix, int iy) {
        grid::Layer values(kSide, kSide, 0.0F);
        values.at(ix, iy) = 1.0F;
        LayerStyle style = grey();
        style.map = ColorMap::viridis;
        const Picture sheet =
            render_layer_sheet(grid_of(kSide, kSide), {{values, style}}, 1, {}, nothing_over_it());
        PointPx sum;
        int pixels = 0;
        for (int v = 0; v < sheet.height(); ++v) {
            for (int u = 0; u < sheet.width() - 100; ++u) {  // without the bar
                if (!(sheet.at(u, v) == color_at(ColorMap::viridis, 1.0))) continue;
                sum.u += u;
                sum.v += v;
                ++pixels;
            }
        }
        EXPECT_GT(pixels, 100);
        return PointPx{sum.u / pixels, sum.v / pixels};
    };
    const PointPx middle = centre_of_ink(5, 5);
    EXPECT_LT(centre_of_ink(8, 5).v, middle.v - 20.0);
    EXPECT_LT(centre_of_ink(5, 8).u, middle.u - 20.0);
}

TEST(LayerSheet, GrowsByRowsAndShowsEveryLayer) {
    const grid::Layer values(20, 30, 0.5F);
    const std::vector<SheetLayer> two(2, {values, grey()});
    const std::vector<SheetLayer> five(5, {values, grey()});
    const Picture small = render_layer_sheet(grid_of(20, 30), two, 2, {}, nothing_over_it());
    const Picture large = render_layer_sheet(grid_of(20, 30), five, 2, {}, nothing_over_it());
    EXPECT_EQ(small.width(), large.width());
    EXPECT_GT(large.height(), 2 * small.height());
    const Rgb8 half = color_at(ColorMap::grey, 0.5);
    EXPECT_GT(count(small, half), 10000);
    EXPECT_EQ(2 * count(large, half), 5 * count(small, half));
    EXPECT_TRUE(render_layer_sheet(grid_of(20, 30), {}, 2, {}, {}).empty());
}

TEST(LayerSheet, AMapThatKnowsNothingIsHatched) {
    const grid::Layer nothing(20, 20, kNanF);
    const Picture sheet =
        render_layer_sheet(grid_of(20, 20), {{nothing, grey()}}, 4, {}, nothing_over_it());
    EXPECT_GT(count(sheet, hatched_grey(0, 0)), 1000);
}

TEST(LayerSheet, EveryLayerHasItsTitleAndRatingsShareTheirScale) {
    for (const char* name : {"elevation",
                             "variance",
                             "drift",
                             "highest",
                             "lowest",
                             "clearance",
                             "count",
                             "confidence",
                             "density_ratio",
                             "lower_bound",
                             "upper_bound",
                             "normal_x",
                             "normal_y",
                             "normal_z"}) {
        EXPECT_NE(style_of_layer(name, 0.8).text.title, name);
    }
    for (const char* name : {"slope", "step", "roughness", "traversability"}) {
        const LayerStyle style = style_of_layer(name, 0.7);
        EXPECT_EQ(style.map, ColorMap::safety) << name;
        EXPECT_EQ(style.centre, 0.7) << name;
    }
    EXPECT_EQ(style_of_layer("temperature", 0.8).text.title, "temperature");
}

}  // namespace
}  // namespace surefoot::eval
