// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/colormap.hpp"

namespace surefoot::eval {

/// Sizes shared by all figures [px].
namespace layout {
inline constexpr double kTitleCap_px = 19.0;
inline constexpr double kTextCap_px = 13.0;
inline constexpr int kMargin_px = 28;
inline constexpr int kTitleBand_px = 92;
inline constexpr int kAxisBand_px = 78;  ///< space left of and below a plot with axes
inline constexpr int kBarWidth_px = 30;
inline constexpr int kKeyRow_px = 36;
inline constexpr int kMinBodyHeight_px = 420;
inline constexpr int kMinPictureWidth_px = 900;
}  // namespace layout

/// A white sheet: title on top, the plot, and a legend column to its right.
struct Figure {
    Picture picture;
    RectPx plot;
    RectPx column;
};

struct FigureText {
    std::string title;
    std::string subtitle;  ///< may be empty
};
/// Space for legends [px]; width 0 = no legend column.
struct ColumnSize {
    int width_px = 0;
    int height_px = 0;
};
/// `with_axes` leaves room for tick labels left of and below the plot. A plot that is less
/// high than the legend column is centred beside the column.
[[nodiscard]] Figure make_figure(int plot_width_px,
                                 int plot_height_px,
                                 bool with_axes,
                                 const ColumnSize& column,
                                 const FigureText& text);

/// Shortens `text` with "..." until it is at most `width_px` wide.
[[nodiscard]] std::string fitted_text(const std::string& text,
                                      const TextStyle& style,
                                      double width_px);

/// A second scale on the other side of a colour bar.
struct SecondScale {
    std::string unit;
    std::function<double(double)> from_value;  ///< strictly decreasing, e.g. disparity to depth
    std::vector<double> candidates;            ///< values to label, in order of preference
};
struct ColorBar {
    ColorScale scale;
    std::string unit;
    bool clipped_low = false;  ///< lower values exist: the lower end of the bar is pointed
    bool clipped_high = false;
    std::optional<SecondScale> second;
    std::string low_word;  ///< word beside the part below the centre, e.g. "unsafe"
    std::string high_word;
};
/// Draws the bar; leaves room for `key_rows` entries. Returns the picture row [px] below the bar.
int draw_color_bar(Figure& figure, const ColorBar& bar, int key_rows);

enum class Symbol : std::uint8_t { hatch, body, line, ticked_line, outline, mark, square, none };
struct KeyEntry {
    Symbol symbol = Symbol::square;
    Rgb8 color = palette::kInk;
    std::string label;
    std::optional<Rgb8> dot = {};  ///< colour of the dot inside a Symbol::square
};
/// Draws legend entries from row `top_px` downward in the legend column.
void draw_key(Figure& figure, int top_px, const std::vector<KeyEntry>& entries);
enum class BarKind : std::uint8_t { none, one_scale, two_scales };
/// Returns the smallest legend column for a colour bar and the legend entries below the bar.
[[nodiscard]] ColumnSize column_size(const std::vector<KeyEntry>& entries, BarKind bar);

/// Draws an arrow head at `center` along `direction` (picture axes, unit length).
void draw_body_symbol(Picture& picture, PointPx center, PointPx direction, double size_px);
/// Draws a circle with a cross and a white edge.
void draw_mark_symbol(Picture& picture, PointPx center);

}  // namespace surefoot::eval
