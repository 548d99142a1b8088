// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

using namespace layout;

constexpr double kLabelSpacing_px = 30.0;
constexpr int kTickLength_px = 6;
constexpr double kPoint_px = 18.0;
constexpr int kBarTop_px = 50;     ///< space above the bar for its unit
constexpr int kBarBottom_px = 36;  ///< space between the bar and the legend entries
constexpr int kSmallestBar_px = 160;
constexpr int kLargestBar_px = 620;

TextStyle text_style(TextAnchor anchor, Rgb8 color = palette::kInk) {
    TextStyle style;
    style.cap_height_px = kTextCap_px;
    style.anchor = anchor;
    style.color = color;
    return style;
}

void draw_title(Figure& figure, const FigureText& text, int left_px, int width_px) {
    TextStyle title;
    title.cap_height_px = kTitleCap_px;
    title.bold = true;
    const double title_v = text.subtitle.empty() ? 50.0 : 36.0;
    draw_text(figure.picture,
              {double(left_px), title_v},
              fitted_text(text.title, title, width_px),
              title);
    const TextStyle subtitle = text_style(TextAnchor::left, palette::kSoftInk);
    draw_text(figure.picture,
              {double(left_px), 69.0},
              fitted_text(text.subtitle, subtitle, width_px),
              subtitle);
}

/// Returns the picture row [px] of a value on the bar.
double row_of(const RectPx& bar, const ColorScale& scale, double value) {
    const double share = (value - scale.low) / (scale.high - scale.low);
    return bar.bottom() - share * bar.height;
}

void draw_bar_ticks(Figure& figure, const ColorBar& bar, const RectPx& rect) {
    const int target = std::max(2, static_cast<int>(rect.height / 70));
    const Ticks ticks = nice_ticks(bar.scale.low, bar.scale.high, target);
    for (const double value : ticks.values) {
        const double v = row_of(rect, bar.scale, value);
        const double u = rect.right();
        draw_line(figure.picture, {u, v}, {u + kTickLength_px, v}, 2, palette::kInk);
        draw_text(figure.picture,
                  {u + kTickLength_px + 6, v},
                  ticks.label(value),
                  text_style(TextAnchor::left));
    }
    draw_text(figure.picture,
              {double(rect.right() + 2), rect.top - 24.0},
              bar.unit,
              text_style(TextAnchor::left, palette::kSoftInk));
}

/// Draws a pointed end where values lie beyond the bar. These values have the colour of this end.
void draw_pointed_ends(Figure& figure, const ColorBar& bar, const RectPx& rect) {
    const auto point = [&](double base_v, double tip_v, double value) {
        const std::array<PointPx, 3> triangle = {PointPx{rect.left - 0.5, base_v},
                                                 PointPx{rect.left + 0.5 * rect.width, tip_v},
                                                 PointPx{rect.right() + 0.5, base_v}};
        fill_polygon(figure.picture, triangle, bar.scale(value));
    };
    if (bar.clipped_high) point(rect.top - 3.0, rect.top - kPoint_px, bar.scale.high);
    if (bar.clipped_low) point(rect.bottom() + 3.0, rect.bottom() + kPoint_px, bar.scale.low);
}

void draw_second_ticks(Figure& figure, const ColorBar& bar, const RectPx& rect) {
    const Ticks plain;
    std::vector<double> used_rows;
    for (const double wanted : bar.second->candidates) {
        // from_value is strictly decreasing: bisection finds the bar value of a candidate.
        double low = bar.scale.low;
        double high = bar.scale.high;
        if (wanted > bar.second->from_value(low) || wanted < bar.second->from_value(high)) continue;
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (bar.second->from_value(middle) > wanted ? low : high) = middle;
        }
        const double v = row_of(rect, bar.scale, low);
        const bool free = std::all_of(used_rows.begin(), used_rows.end(), [v](double used) {
            return std::abs(v - used) >= kLabelSpacing_px;
        });
        if (!free) continue;
        used_rows.push_back(v);
        const double u = rect.left;
        draw_line(figure.picture, {u - kTickLength_px, v}, {u, v}, 2, palette::kInk);
        Ticks format;
        format.step = wanted < 1.0 ? 0.1 : 0.5;
        format.decimals = std::abs(wanted - std::round(wanted)) > 1e-9 ? 1 : 0;
        draw_text(figure.picture,
                  {u - kTickLength_px - 6, v},
                  format.label(wanted),
                  text_style(TextAnchor::right));
    }
    draw_text(figure.picture,
              {double(rect.left - 2), rect.top - 24.0},
              bar.second->unit,
              text_style(TextAnchor::right, palette::kSoftInk));
}

void draw_words(Figure& figure, const ColorBar& bar, const RectPx& rect) {
    const double centre_v = row_of(rect, bar.scale, bar.scale.centre);
    const auto word = [&](const std::string& text, double low_v, double high_v, Rgb8 color) {
        TextStyle style = text_style(TextAnchor::centre, color);
        style.bold = true;
        style.upward = true;
        if (text.empty() || text_width_px(text, style) > std::abs(low_v - high_v)) return;
        draw_text(figure.picture, {rect.left - 16.0, 0.5 * (low_v + high_v)}, text, style);
    };
    word(bar.low_word, rect.bottom(), centre_v, bar.scale(bar.scale.low));
    word(bar.high_word, centre_v, rect.top, bar.scale(bar.scale.high));
}

PointPx along(PointPx center, PointPx direction, double forward_px, double left_px) {
    // `left_px` is to the left of the direction, because picture rows grow downward.
    return {center.u + forward_px * direction.u + left_px * direction.v,
            center.v + forward_px * direction.v - left_px * direction.u};
}

void draw_symbol(Figure& figure, const KeyEntry& entry, PointPx center) {
    Picture& picture = figure.picture;
    const RectPx box{static_cast<int>(center.u) - 13, static_cast<int>(center.v) - 10, 26, 20};
    const PointPx left{center.u - 14, center.v};
    const PointPx right{center.u + 14, center.v};
    switch (entry.symbol) {
        case Symbol::hatch:
            for (int v = box.top; v < box.bottom(); ++v) {
                for (int u = box.left; u < box.right(); ++u) picture.at(u, v) = hatched_grey(u, v);
            }
            draw_rect(picture, box, 1, palette::kSoftInk);
            break;
        case Symbol::body: draw_body_symbol(picture, center, {0.0, -1.0}, 24.0); break;
        case Symbol::line: draw_line(picture, left, right, 3, entry.color); break;
        case Symbol::ticked_line:
            draw_line(picture, left, right, 3, entry.color);
            for (const double u : {-9.0, 0.0, 9.0}) {
                draw_line(picture,
                          {center.u + u, center.v},
                          {center.u + u, center.v + 9.0},
                          2,
                          entry.color);
            }
            break;
        case Symbol::none: break;  // text that continues the entry above
        case Symbol::outline: draw_rect(picture, box, 2, entry.color); break;
        case Symbol::mark: draw_mark_symbol(picture, center); break;
        case Symbol::square:
            fill_rect(picture, box, entry.color);
            draw_rect(picture, box, 1, palette::kSoftInk);
            if (entry.dot) fill_circle(picture, center, 5.5, *entry.dot);
            break;
    }
}

}  // namespace

std::string fitted_text(const std::string& text, const TextStyle& style, double width_px) {
    if (text_width_px(text, style) <= width_px) return text;
    std::string cut = text;
    while (!cut.empty() && text_width_px(cut + "...", style) > width_px) cut.pop_back();
    return cut + "...";
}

Figure make_figure(int plot_width_px,
                   int plot_height_px,
                   bool with_axes,
                   const ColumnSize& column,
                   const FigureText& text) {
    Figure figure;
    const int left = kMargin_px + (with_axes ? kAxisBand_px : 0);
    const int below = kMargin_px + (with_axes ? kAxisBand_px - 12 : 0);
    const int height = std::max({plot_height_px, column.height_px, kMinBodyHeight_px});
    figure.plot = {
        left, kTitleBand_px + (height - plot_height_px) / 2, plot_width_px, plot_height_px};
    figure.column = {figure.plot.right() + kMargin_px, kTitleBand_px, column.width_px, height};
    const int needed =
        figure.plot.right() + kMargin_px + (column.width_px > 0 ? column.width_px + 8 : 0);
    const int width = std::max(kMinPictureWidth_px, needed);
    figure.picture = Picture(width, kTitleBand_px + height + below, palette::kPaper);
    draw_title(figure, text, left, width - left - kMargin_px);
    return figure;
}

int draw_color_bar(Figure& figure, const ColorBar& bar, int key_rows) {
    const int top = figure.column.top + kBarTop_px;
    const int free_px = figure.column.bottom() - top - key_rows * kKeyRow_px - kBarBottom_px;
    const bool has_left = bar.second.has_value() || !bar.low_word.empty();
    const int left = figure.column.left + (bar.second ? 56 : has_left ? 34 : 4);
    const RectPx rect{
        left, top, kBarWidth_px, std::clamp(free_px, kSmallestBar_px, kLargestBar_px)};
    for (int v = rect.top; v < rect.bottom(); ++v) {
        const double share = (rect.bottom() - v - 0.5) / rect.height;
        const double value = bar.scale.low + share * (bar.scale.high - bar.scale.low);
        fill_rect(figure.picture, {rect.left, v, rect.width, 1}, bar.scale(value));
    }
    draw_rect(figure.picture, rect, 1, palette::kSoftInk);
    draw_pointed_ends(figure, bar, rect);
    draw_bar_ticks(figure, bar, rect);
    if (bar.second) {
        draw_second_ticks(figure, bar, rect);
    } else {
        draw_words(figure, bar, rect);
    }
    return rect.bottom() + kBarBottom_px;
}

void draw_key(Figure& figure, int top_px, const std::vector<KeyEntry>& entries) {
    double v = top_px + 0.5 * kKeyRow_px;
    for (const KeyEntry& entry : entries) {
        draw_symbol(figure, entry, {figure.column.left + 18.0, v});
        draw_text(figure.picture,
                  {figure.column.left + 44.0, v},
                  entry.label,
                  text_style(TextAnchor::left));
        v += kKeyRow_px;
    }
}

ColumnSize column_size(const std::vector<KeyEntry>& entries, BarKind bar) {
    double width_px = bar == BarKind::two_scales ? 190.0 : 150.0;
    for (const KeyEntry& entry : entries) {
        width_px =
            std::max(width_px, 56.0 + text_width_px(entry.label, text_style(TextAnchor::left)));
    }
    const int bar_px = bar == BarKind::none ? 0 : kBarTop_px + kSmallestBar_px + kBarBottom_px;
    return {saturated_integer<int>(std::ceil(width_px)),
            bar_px + static_cast<int>(entries.size()) * kKeyRow_px};
}

void draw_body_symbol(Picture& picture, PointPx center, PointPx direction, double size_px) {
    const auto at = [&](double forward, double left) {
        return along(center, direction, forward * size_px, left * size_px);
    };
    const std::array<PointPx, 4> arrow = {
        at(0.62, 0.0), at(-0.45, 0.42), at(-0.2, 0.0), at(-0.45, -0.42)};
    draw_polyline(picture, arrow, 6, palette::kPaper, true);
    fill_polygon(picture, arrow, palette::kInk);
}

void draw_mark_symbol(Picture& picture, PointPx center) {
    const auto cross = [&](int width_px, Rgb8 color) {
        draw_circle(picture, center, 11.0, width_px, color);
        draw_line(picture, {center.u - 5, center.v}, {center.u + 5, center.v}, width_px, color);
        draw_line(picture, {center.u, center.v - 5}, {center.u, center.v + 5}, width_px, color);
    };
    cross(6, palette::kPaper);
    cross(2, palette::kInk);
}

}  // namespace surefoot::eval
