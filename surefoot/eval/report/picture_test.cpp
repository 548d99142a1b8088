// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/picture.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr int kLeft = layout::kMargin_px + layout::kAxisBand_px;
constexpr int kTop = layout::kTitleBand_px;

grid::GridGeometry small_grid() {
    return {0.5, 4, 6, {-1.0, -1.5}};
}  // 200 px per cell: x 4, y 6

LayerStyle plain(ColorMap map = ColorMap::grey) {
    LayerStyle style;
    style.map = map;
    style.range = ValueRange{0.0, 1.0};
    return style;
}

Overlays without_scale_bar() {
    Overlays overlays;
    overlays.scale_bar = false;
    return overlays;
}

bool is_hatch(Rgb8 color) {
    return color.r >= 221 && color.r <= 240 && color.b >= color.r;
}

/// Pixels of an area that are not paper.
int ink(const Picture& picture, const RectPx& rect) {
    int count = 0;
    for (int v = rect.top; v < rect.bottom(); ++v) {
        for (int u = rect.left; u < rect.right(); ++u) {
            count += picture.at(u, v) == palette::kPaper ? 0 : 1;
        }
    }
    return count;
}

TEST(Picture, ForwardIsUpAndLeftIsLeft) {
    const grid::GridGeometry geometry = small_grid();
    const int cell = 134;  // ceil(800 px / 6 cells)
    for (const int iy : {0, 2, 5}) {
        for (const int ix : {0, 1, 3}) {
            grid::Layer layer(geometry.nx, geometry.ny, 0.0F);
            layer.at(ix, iy) = 1.0F;
            const Picture picture = render_layer(geometry, layer, plain(), without_scale_bar());
            const int u = kLeft + (geometry.ny - 1 - iy) * cell;
            const int v = kTop + (geometry.nx - 1 - ix) * cell;
            // Ticks of the axes reach two pixels into the plot.
            EXPECT_EQ(picture.at(u + 3, v + 3), palette::kPaper) << ix << " " << iy;
            EXPECT_EQ(picture.at(u + cell - 3, v + cell - 3), palette::kPaper);
            if (iy > 0) {
                EXPECT_EQ(picture.at(u + cell, v + 3), palette::kBlack);
            }
            if (ix > 0) {
                EXPECT_EQ(picture.at(u + 3, v + cell), palette::kBlack);
            }
        }
    }
}

TEST(Picture, UnknownIsHatchedAndNeverAColourOfTheMap) {
    const grid::GridGeometry geometry = small_grid();
    const Picture picture =
        render_layer(geometry, grid::Layer(4, 6, kNanF), plain(ColorMap::safety), {});
    for (int k = 1; k < 130; ++k) EXPECT_TRUE(is_hatch(picture.at(kLeft + k, kTop + 2 * k)));
    for (const ColorMap map : {ColorMap::viridis, ColorMap::cividis, ColorMap::safety}) {
        for (int k = 0; k <= 100; ++k) EXPECT_FALSE(is_hatch(color_at(map, 0.01 * k)));
    }
}

TEST(Picture, EveryPictureIsWideEnoughForATalkAndSmallEnoughForAPage) {
    Rng rng(9);
    for (const auto& [nx, ny] :
         {std::pair{1, 1}, {3, 400}, {400, 3}, {240, 240}, {719, 721}, {1700, 1500}}) {
        grid::GridGeometry geometry{0.1, nx, ny, {0.0, 0.0}};
        grid::Layer layer(nx, ny);
        for (std::size_t i = 0; i < layer.size(); ++i)
            layer.data()[i] = static_cast<float>(rng.uniform());
        const Picture picture = render_layer(geometry, layer, elevation_style(), {});
        EXPECT_GE(picture.width(), 900) << nx << " x " << ny;
        EXPECT_LE(picture.width(), 2000) << nx << " x " << ny;
        EXPECT_LE(picture.height(), 1900) << nx << " x " << ny;
    }
    EXPECT_GE(render_camera_image(GreyImage(640, 480, 90), {"t", ""}).width(), 900);
    EXPECT_GE(render_camera_image(GreyImage(), {"t", ""}).width(), 900);
    EXPECT_LE(render_camera_image(GreyImage(4000, 3000, 90), {"t", ""}).width(), 1700);
    EXPECT_GE(render_trajectory({}, {}, {"t", ""}).width(), 900);
}

TEST(Picture, NothingTouchesTheMargin) {
    const std::string longest(150, 'W');
    LayerStyle style = traversability_style(0.8);
    style.text = {longest, longest};
    Overlays overlays;
    overlays.T_odom_body = Pose{};
    overlays.outlines = {
        {{{0, 0}, {1, 0}, {1, 1}}, palette::kSafe, "a rather long name of a foot"}};
    const grid::GridGeometry geometry{0.025, 240, 240, {-3.0, -3.0}};
    const grid::Layer layer(240, 240, 0.5F);
    for (const Picture& picture :
         {render_layer(geometry, layer, style, overlays),
          render_error_map(geometry, layer, style.text, overlays),
          render_confusion(geometry, Image<Call>(240, 240, Call::false_safe), style.text, overlays),
          render_disparity(Image<float>(672, 376, 12.5F), 41.0, style.text),
          render_sigma(Image<float>(672, 376, 0.25F), "px", style.text),
          render_camera_image(GreyImage(672, 376, 0), style.text),
          render_trajectory({{0, {}}, {1, {}}}, {}, style.text)}) {
        const int w = picture.width();
        const int h = picture.height();
        EXPECT_EQ(ink(picture, {0, 0, w, 8}), 0);
        EXPECT_EQ(ink(picture, {0, h - 8, w, 8}), 0);
        EXPECT_EQ(ink(picture, {0, 0, 8, h}), 0);
        EXPECT_EQ(ink(picture, {w - 8, 0, 8, h}), 0);
        EXPECT_GT(ink(picture, {0, 0, w, layout::kTitleBand_px - 4}), 500);  // the title is there
    }
}

TEST(Picture, ErrorMapIsRedWhereTheMapIsTooLow) {
    const grid::GridGeometry geometry{0.5, 2, 2, {0.0, 0.0}};
    grid::Layer error_m(2, 2, 0.0F);
    error_m.at(1, 1) = -0.02F;  // upper left: the truth is above the map
    error_m.at(1, 0) = 0.02F;   // upper right
    const Picture picture = render_error_map(geometry, error_m, {"t", ""}, without_scale_bar());
    const Rgb8 low = picture.at(kLeft + 100, kTop + 100);
    const Rgb8 high = picture.at(kLeft + 700, kTop + 100);
    EXPECT_GT(low.r, low.b + 60);
    EXPECT_GT(high.b, high.r + 60);
    EXPECT_EQ(picture.at(kLeft + 100, kTop + 700), color_at(ColorMap::balance, 0.5));
}

TEST(Picture, ConfusionColours) {
    const grid::GridGeometry geometry{0.5, 1, 4, {0.0, 0.0}};
    Image<Call> calls(1, 4);
    calls.at(0, 3) = Call::true_safe;  // leftmost
    calls.at(0, 2) = Call::true_unsafe;
    calls.at(0, 1) = Call::false_safe;
    calls.at(0, 0) = Call::false_unsafe;
    const Picture picture = render_confusion(geometry, calls, {"t", ""}, without_scale_bar());
    const int top =
        kTop + (layout::kMinBodyHeight_px - 200) / 2;  // one row of 200 px cells, centred
    const auto ground = [&](int k) { return picture.at(kLeft + 200 * k + 4, top + 4); };
    const auto dot = [&](int k) { return picture.at(kLeft + 200 * k + 100, top + 100); };
    EXPECT_EQ(ground(0), palette::kPaper);
    EXPECT_EQ(dot(0), palette::kGreen);
    EXPECT_EQ(ground(1), palette::kBlack);
    EXPECT_EQ(dot(1), palette::kGreen);
    EXPECT_EQ(ground(2), palette::kPaper);
    EXPECT_EQ(dot(2), palette::kSafe);  // blue on white
    EXPECT_EQ(ground(3), palette::kBlack);
    EXPECT_EQ(dot(3), palette::kUnsafe);
}

TEST(Picture, ConfusionThumbnailIsCutToWhatIsKnown) {
    constexpr int kSide = 200;
    constexpr int kCell_px = 4;
    const grid::GridGeometry geometry{0.05, kSide, kSide, {0.0, 0.0}};
    Image<Call> calls(kSide, kSide, Call::unknown);
    EXPECT_TRUE(render_confusion_thumbnail(geometry, calls, without_scale_bar()).empty());
    calls.at(199, 30) = Call::false_safe;  // farthest ahead
    Picture one = render_confusion_thumbnail(geometry, calls, without_scale_bar());
    EXPECT_EQ(one.width(), kThumbnailCells * kCell_px);
    EXPECT_EQ(one.height(), kThumbnailCells * kCell_px);
    calls.at(40, 150) = Call::false_unsafe;  // leftmost and last
    const Picture two = render_confusion_thumbnail(geometry, calls, without_scale_bar());
    ASSERT_EQ(two.height(), (199 - 40 + 1) * kCell_px);
    ASSERT_EQ(two.width(), (150 - 30 + 1) * kCell_px);
    EXPECT_EQ(two.at(two.width() - 1, kCell_px - 1), palette::kPaper);
    EXPECT_EQ(two.at(two.width() - kCell_px + 2, 2), palette::kSafe);
    EXPECT_EQ(two.at(2, two.height() - 2), palette::kUnsafe);
    EXPECT_EQ(two.at(2, 2), palette::kFaint);
    Overlays overlays = without_scale_bar();
    overlays.trajectory_m = {{0.02, 7.0}, {-3.0, 7.0}};  // cell 0, and outside of the grid
    EXPECT_EQ(render_confusion_thumbnail(geometry, calls, overlays).height(), 200 * kCell_px);
}

TEST(Picture, MarksAreNamedInTheKeyAndHideLittleOfTheMap) {
    const grid::GridGeometry geometry{0.025, 240, 240, {-3.0, -3.0}};
    const grid::Layer layer(240, 240, 0.0F);
    Overlays overlays = without_scale_bar();
    overlays.marks = {{{0.0, 0.0}, "this decided"}};
    const auto key = key_of(overlays);
    ASSERT_EQ(key.size(), 1U);
    EXPECT_EQ(key[0].symbol, Symbol::mark);
    EXPECT_EQ(key[0].label, "this decided");
    const Picture drawn = render_layer(geometry, layer, plain(), overlays);
    overlays.marks.clear();
    const Picture bare = render_layer(geometry, layer, plain(), overlays);
    constexpr int kSide = 960;
    constexpr int kSymbol_px = 20;  // from its centre, white edge included
    for (int v = kTop; v < kTop + kSide; ++v) {
        for (int u = kLeft; u < kLeft + kSide; ++u) {
            const int far =
                std::max(std::abs(u - kLeft - kSide / 2), std::abs(v - kTop - kSide / 2));
            if (far > kSymbol_px) {
                ASSERT_EQ(bare.at(u, v), drawn.at(u, v)) << u << ", " << v;
            }
        }
    }
}

TEST(Picture, OverlaysStayInsideTheMap) {
    const grid::GridGeometry geometry{0.025, 240, 240, {-3.0, -3.0}};
    const grid::Layer layer(240, 240, 0.0F);
    Overlays overlays = without_scale_bar();
    const Picture bare = render_layer(geometry, layer, plain(), overlays);
    overlays.trajectory_m = {{-50.0, -50.0}, {50.0, 50.0}, {kNanF, 0.0}};
    overlays.marks = {{{2.99, -2.99}, "corner"}};
    const Picture drawn = render_layer(geometry, layer, plain(), overlays);
    const int side = 960;
    EXPECT_NE(drawn.at(kLeft + side / 2, kTop + side / 2),
              bare.at(kLeft + side / 2, kTop + side / 2));
    for (int v = 0; v < kTop - 4; ++v) {
        for (int u = 0; u < bare.width(); ++u) ASSERT_EQ(bare.at(u, v), drawn.at(u, v));
    }
    for (int v = kTop; v < kTop + side; ++v) {
        for (int u = 0; u < kLeft - 4; ++u) ASSERT_EQ(bare.at(u, v), drawn.at(u, v));
    }
}

TEST(Picture, ShownRangeIgnoresAFewWildValues) {
    Image<float> values(100, 10);
    for (int k = 0; k < 1000; ++k) values.data()[k] = 0.001F * static_cast<float>(k);
    values.data()[0] = -500.0F;
    values.data()[999] = std::numeric_limits<float>::infinity();
    values.data()[998] = 900.0F;
    values.data()[500] = kNanF;
    LayerStyle style;
    const ValueRange range = shown_range(values, style);
    EXPECT_NEAR(range.low, 0.010, 0.002);
    EXPECT_NEAR(range.high, 0.989, 0.002);
    style.min_span = 4.0;
    EXPECT_NEAR(shown_range(values, style).high - shown_range(values, style).low, 4.0, 1e-9);
    style.value_scale = 1000.0;
    EXPECT_NEAR(shown_range(values, style).high, 989.0, 2.0);
    EXPECT_EQ(shown_range(Image<float>(3, 3, kNanF), style).high, 1.0);
}

TEST(Picture, HillShadingKeepsLevelGroundAsItIs) {
    const grid::GridGeometry geometry{0.5, 2, 2, {0.0, 0.0}};
    LayerStyle style = plain(ColorMap::viridis);
    const grid::Layer level(2, 2, 0.5F);
    const Picture flat = render_layer(geometry, level, style, {});
    style.hill_shading = true;
    EXPECT_EQ(render_layer(geometry, level, style, {}), flat);
}

TEST(Picture, PngHoldsThePictureAndIsTheSameEachTime) {
    const grid::GridGeometry geometry = small_grid();
    grid::Layer layer(4, 6);
    for (std::size_t i = 0; i < layer.size(); ++i) layer.data()[i] = static_cast<float>(i) / 24.0F;
    const Picture picture = render_layer(geometry, layer, elevation_style(), {});
    const auto png = encode_png(picture);
    EXPECT_EQ(png, encode_png(render_layer(geometry, layer, elevation_style(), {})));
    const cv::Mat decoded = cv::imdecode(png, cv::IMREAD_COLOR);
    ASSERT_EQ(decoded.cols, picture.width());
    ASSERT_EQ(decoded.rows, picture.height());
    for (int v = 0; v < decoded.rows; v += 7) {
        for (int u = 0; u < decoded.cols; u += 7) {
            const auto bgr = decoded.at<cv::Vec3b>(v, u);
            ASSERT_EQ(picture.at(u, v), (Rgb8{bgr[2], bgr[1], bgr[0]}));
        }
    }
    EXPECT_TRUE(encode_png(Picture()).empty());
}

TEST(Picture, OddInputDrawsWithoutHarm) {
    EXPECT_FALSE(render_disparity(Image<float>(), 41.0, {"", ""}).empty());
    EXPECT_FALSE(
        render_disparity(Image<float>(4, 4, kNanF), 41.0, {"no match at all", ""}).empty());
    EXPECT_FALSE(render_disparity(Image<float>(4, 4, -3.0F), 41.0, {"negative", ""}).empty());
    EXPECT_FALSE(render_sigma(Image<float>(4, 4, 0.0F), "px", {"\xc3\xa4 \n \x01", ""}).empty());
    Pose lost;
    lost.translation_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(render_trajectory({{0, lost}, {1, {}}}, {{0, lost}}, {"lost", ""}).empty());
    const grid::GridGeometry none{0.025, 0, 0, {0.0, 0.0}};
    EXPECT_FALSE(render_layer(none, grid::Layer(), elevation_style(), {}).empty());
    Overlays overlays;
    overlays.T_odom_body = lost;
    overlays.marks = {{lost.translation_m.head<2>(), "nowhere"}};
    EXPECT_FALSE(
        render_layer(small_grid(), grid::Layer(4, 6, 0.0F), elevation_style(), overlays).empty());
}

/// Row of the highest pixel of the line in a column of the plot, or -1.
int line_row(const Picture& picture, int u) {
    for (int v = 0; v < picture.height(); ++v)
        if (picture.at(u, v) == palette::kSafe) return v;
    return -1;
}

TEST(Picture, TheErrorLineRisesWithTheErrorAndKeepsPeaks) {
    std::vector<ErrorSample> samples;
    for (int k = 0; k <= 10000; ++k) samples.push_back({0.01 * k, k == 5000 ? 0.020 : 0.005});
    const Picture picture = render_error_over_time(samples, {"Error", ""});
    const int low = line_row(picture, kLeft + 190);
    const int peak = line_row(picture, kLeft + 380);
    ASSERT_GT(peak, 0);
    // 15 mm of the 22 mm on 400 px, and the line's own width.
    EXPECT_NEAR(low - peak, 15.0 / 22.0 * 400.0, 4.0);
    EXPECT_EQ(line_row(picture, kLeft - 20), -1);
}

TEST(Picture, ErrorsWithoutAnySampleOrSizeStillDraw) {
    const float nan = kNanF;
    for (const auto& samples : {std::vector<ErrorSample>{},
                                std::vector<ErrorSample>{{3.0, 0.0}},
                                std::vector<ErrorSample>{{0.0, 0.0}, {1.0, 0.0}},
                                std::vector<ErrorSample>{{0.0, double{nan}}, {0.0, 1e6}}}) {
        const Picture picture = render_error_over_time(samples, {"Error", ""});
        EXPECT_GE(picture.width(), 900);
    }
}

TEST(Picture, StackedHoldsBoth) {
    const Picture upper(20, 10, palette::kInk), lower(30, 5, palette::kGreen);
    const Picture sheet = stacked(upper, lower);
    EXPECT_EQ(sheet.width(), 30);
    EXPECT_EQ(sheet.height(), 15);
    EXPECT_EQ(sheet.at(19, 9), palette::kInk);
    EXPECT_EQ(sheet.at(20, 9), palette::kPaper);
    EXPECT_EQ(sheet.at(29, 14), palette::kGreen);
}

}  // namespace
}  // namespace surefoot::eval
