// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/classes_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace surefoot::eval {
namespace {

using stairs::GroundClass;

constexpr int kLeft = layout::kMargin_px + layout::kAxisBand_px;
constexpr int kTop = layout::kTitleBand_px;
constexpr std::size_t kClasses = stairs::kGroundClassNames.size();

int count(const Picture& picture, const RectPx& rect, Rgb8 color) {
    int found = 0;
    for (int v = rect.top; v < rect.bottom(); ++v)
        for (int u = rect.left; u < rect.right(); ++u) found += picture.at(u, v) == color ? 1 : 0;
    return found;
}

Picture drawn(const stairs::GroundClasses& classes) {
    const int nx = classes.of_cell.width(), ny = classes.of_cell.height();
    Overlays overlays;
    overlays.scale_bar = false;
    return render_classes(
        {0.1, nx, ny, {0.0, 0.0}}, grid::Layer(nx, ny, 0.0F), classes, overlays, {"t", ""});
}

TEST(ClassesPicture, EachCellHasTheColourOfItsClass) {
    stairs::GroundClasses classes;
    classes.of_cell = Image<GroundClass>(36, 36, GroundClass::floor);
    classes.of_cell.at(35, 0) = GroundClass::drop;  // farthest ahead, at the right
    classes.of_cell.at(0, 35) = GroundClass::unknown;
    const Picture picture = drawn(classes);
    // With its rim the map has 40 cells of 20 px a side.
    EXPECT_EQ(count(picture, {kLeft, kTop, 800, 800}, color_of(GroundClass::drop)), 400);
    EXPECT_EQ(count(picture, {kLeft + 740, kTop + 40, 20, 20}, color_of(GroundClass::drop)), 400);
    EXPECT_EQ(count(picture, {kLeft, kTop, 800, 800}, color_of(GroundClass::floor)),
              400 * (36 * 36 - 2));
    EXPECT_EQ(picture.at(kLeft + 50, kTop + 750), hatched_grey(50, 750));
}

TEST(ClassesPicture, TheKeyHoldsWhatThereIs) {
    stairs::GroundClasses classes;
    classes.of_cell = Image<GroundClass>(36, 36, GroundClass::floor);
    const auto in_key = [&](GroundClass name) {
        const Picture picture = drawn(classes);
        const int right_of_plot = kLeft + 810;
        return count(picture,
                     {right_of_plot, kTop, picture.width() - right_of_plot, 600},
                     color_of(name)) > 0;
    };
    EXPECT_TRUE(in_key(GroundClass::floor));
    EXPECT_FALSE(in_key(GroundClass::table));
    classes.of_cell.at(3, 3) = GroundClass::table;
    EXPECT_TRUE(in_key(GroundClass::table));
}

/// Returns a colour as a dichromat sees it, in linear RGB (Vienot, Brettel and Mollon 1999).
std::array<double, 3> seen_by_dichromat(Rgb8 color, bool no_red) {
    const auto linear = [](std::uint8_t value) { return std::pow(value / 255.0, 2.2); };
    const double r = linear(color.r), g = linear(color.g), b = linear(color.b);
    if (no_red)
        return {
            0.11238 * r + 0.88762 * g, 0.11238 * r + 0.88762 * g, 0.00401 * r - 0.00401 * g + b};
    return {0.29275 * r + 0.70725 * g, 0.29275 * r + 0.70725 * g, -0.02234 * r + 0.02234 * g + b};
}

TEST(ClassesPicture, NoTwoClassesLookAlikeToAnyEye) {
    for (const bool no_red : {false, true}) {
        for (std::size_t i = 1; i < kClasses; ++i) {
            for (std::size_t k = i + 1; k < kClasses; ++k) {
                const auto a = seen_by_dichromat(color_of(static_cast<GroundClass>(i)), no_red);
                const auto b = seen_by_dichromat(color_of(static_cast<GroundClass>(k)), no_red);
                double most = 0.0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto shown = [](double x) { return std::pow(std::max(0.0, x), 1 / 2.2); };
                    most = std::max(most, std::abs(shown(a[c]) - shown(b[c])));
                }
                EXPECT_GT(most, 0.1)
                    << stairs::kGroundClassNames[i] << " and " << stairs::kGroundClassNames[k];
            }
        }
    }
}

TEST(ClassesPicture, AnEmptyMapIsDrawnWithoutHarm) {
    EXPECT_FALSE(
        render_classes({0.025, 0, 0, {0.0, 0.0}}, grid::Layer(), {}, {}, {"", ""}).empty());
}

}  // namespace
}  // namespace surefoot::eval
