// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/map_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

constexpr int kTickLength_px = 6;
constexpr double kSmallestBody_px = 30.0;
constexpr double kBodyLength_m = 0.35;

TextStyle label_style(TextAnchor anchor) {
    TextStyle style;
    style.cap_height_px = layout::kTextCap_px;
    style.anchor = anchor;
    return style;
}

int tick_count(int length_px) {
    return std::max(2, length_px / 110);
}

/// Copies the plot area, so that drawing cannot cross the border of the plot.
Picture cut_out(const Picture& picture, const RectPx& rect) {
    Picture part(rect.width, rect.height);
    paste(part, picture, -rect.left, -rect.top);
    return part;
}

std::vector<PointPx> to_px(const MapView& view, const std::vector<Eigen::Vector2d>& points_m) {
    std::vector<PointPx> points;
    for (const Eigen::Vector2d& p_m : points_m) {
        if (p_m.allFinite()) points.push_back(view.to_px(p_m));
    }
    return points;
}

void draw_body(Picture& picture,
               const MapView& view,
               const Pose& T_odom_body,
               const std::optional<double>& length_px) {
    const double yaw = yaw_rad(T_odom_body);
    const PointPx forward{-std::sin(yaw), -std::cos(yaw)};  // +x is up, +y is left
    draw_body_symbol(picture,
                     view.to_px(T_odom_body.translation_m.head<2>()),
                     forward,
                     length_px.value_or(std::max(kSmallestBody_px, kBodyLength_m * view.px_per_m)));
}

constexpr double kTickSpacing_px = 16.0;
constexpr double kFallTick_px = 10.0;
constexpr int kHalo_px = 4;  ///< sum of the widths of the two white edges of a line

/// Returns the two ends of each tick on the right of a line.
std::vector<std::pair<PointPx, PointPx>> ticks_of(const MapView& view, const Stroke& stroke) {
    std::vector<std::pair<PointPx, PointPx>> ticks;
    for (std::size_t i = 0; stroke.ticks && i + 1 < stroke.points_m.size(); ++i) {
        const Eigen::Vector2d from_m = stroke.points_m[i];
        const double length_m = (stroke.points_m[i + 1] - from_m).norm();
        const double spacing_m = kTickSpacing_px / view.px_per_m;
        if (!(length_m > 0.0 && length_m < 1e4 * spacing_m)) continue;
        const Eigen::Vector2d along = (stroke.points_m[i + 1] - from_m) / length_m;
        const Eigen::Vector2d tick_m =
            kFallTick_px / view.px_per_m * Eigen::Vector2d(along.y(), -along.x());
        for (double t_m = 0.5 * spacing_m; t_m < length_m; t_m += spacing_m) {
            const Eigen::Vector2d foot_m = from_m + t_m * along;
            ticks.emplace_back(view.to_px(foot_m), view.to_px(foot_m + tick_m));
        }
    }
    return ticks;
}

/// Returns the corners of the arrow head at the last point, the tip first; empty without a
/// direction.
std::vector<PointPx> arrow_head(const MapView& view, const Stroke& stroke) {
    const std::vector<PointPx> points = to_px(view, stroke.points_m);
    if (!stroke.arrow || points.size() < 2) return {};
    const PointPx tip = points.back();
    const PointPx before = points[points.size() - 2];
    const double length_px = std::hypot(tip.u - before.u, tip.v - before.v);
    if (!(length_px > 0.0)) return {};
    const double u = (tip.u - before.u) / length_px;
    const double v = (tip.v - before.v) / length_px;
    const double back_px = 10.0 + 2.0 * stroke.width_px;
    const double side_px = 4.0 + 1.5 * stroke.width_px;
    const double ahead_px = 0.5 * back_px;
    return {{tip.u + ahead_px * u, tip.v + ahead_px * v},
            {tip.u - (back_px - ahead_px) * u - side_px * v,
             tip.v - (back_px - ahead_px) * v + side_px * u},
            {tip.u - (back_px - ahead_px) * u + side_px * v,
             tip.v - (back_px - ahead_px) * v - side_px * u}};
}

/// Draws all white edges before all lines, so that no edge covers a line.
void draw_strokes(Picture& picture, const MapView& view, const std::vector<Stroke>& strokes) {
    const auto draw_all = [&](bool halo) {
        for (const Stroke& stroke : strokes) {
            const Rgb8 color = halo ? palette::kPaper : stroke.color;
            const int wider_px = halo ? kHalo_px : 0;
            draw_polyline(picture, to_px(view, stroke.points_m), stroke.width_px + wider_px, color);
            for (const auto& [from, to] : ticks_of(view, stroke))
                draw_line(picture, from, to, 2 + wider_px, color);
            const std::vector<PointPx> head = arrow_head(view, stroke);
            if (head.empty()) continue;
            if (halo) {
                draw_polyline(picture, head, kHalo_px, color, true);
            } else {
                fill_polygon(picture, head, color);
            }
        }
    };
    draw_all(true);
    draw_all(false);
}

void draw_badges(Picture& picture, const MapView& view, const std::vector<Badge>& badges) {
    constexpr double kRadius_px = 12.0;
    std::vector<PointPx> taken;
    for (const Badge& badge : badges) {
        if (!badge.point_m.allFinite()) continue;
        const PointPx at = view.to_px(badge.point_m);
        const bool covers = std::any_of(taken.begin(), taken.end(), [at](const PointPx& other) {
            return std::hypot(at.u - other.u, at.v - other.v) < 2.0 * kRadius_px + 3.0;
        });
        if (covers) continue;
        taken.push_back(at);
        fill_circle(picture, at, kRadius_px + 2.0, palette::kPaper);
        fill_circle(picture, at, kRadius_px, badge.color);
        TextStyle style = label_style(TextAnchor::centre);
        style.cap_height_px = 11.0;
        style.color = palette::kPaper;
        style.bold = true;
        draw_text(picture, at, badge.text, style);
    }
}

/// Adds one legend row for each line of the label; skips labels that already exist.
void add_label(const std::string& label,
               Symbol symbol,
               Rgb8 color,
               std::vector<KeyEntry>& entries) {
    const std::string first = label.substr(0, label.find('\n'));
    const auto same = [&](const KeyEntry& entry) { return entry.label == first; };
    if (first.empty() || std::any_of(entries.begin(), entries.end(), same)) return;
    entries.push_back({symbol, color, first, {}});
    for (std::size_t end = first.size(); end < label.size();) {
        const std::size_t begin = end + 1;
        end = std::min(label.find('\n', begin), label.size());
        entries.push_back({Symbol::none, color, label.substr(begin, end - begin), {}});
    }
}

}  // namespace

void draw_axes(Picture& picture, const MapView& view) {
    const RectPx& plot = view.plot;
    draw_rect(picture, plot, 2, palette::kInk);
    const Ticks x_ticks = nice_ticks(view.x_min_m(), view.x_max_m, tick_count(plot.height));
    for (const double x_m : x_ticks.values) {
        const double v = view.to_px({x_m, 0.0}).v;
        draw_line(
            picture, {plot.left - 2.0 - kTickLength_px, v}, {plot.left - 2.0, v}, 2, palette::kInk);
        draw_text(
            picture, {plot.left - 14.0, v}, x_ticks.label(x_m), label_style(TextAnchor::right));
    }
    const Ticks y_ticks = nice_ticks(view.y_min_m(), view.y_max_m, tick_count(plot.width));
    for (const double y_m : y_ticks.values) {
        const double u = view.to_px({0.0, y_m}).u;
        draw_line(picture,
                  {u, plot.bottom() + 2.0},
                  {u, plot.bottom() + 2.0 + kTickLength_px},
                  2,
                  palette::kInk);
        draw_text(picture,
                  {u, plot.bottom() + 24.0},
                  y_ticks.label(y_m),
                  label_style(TextAnchor::centre));
    }
    TextStyle name = label_style(TextAnchor::centre);
    name.color = palette::kSoftInk;
    draw_text(picture, {plot.left + 0.5 * plot.width, plot.bottom() + 60.0}, "y (left) [m]", name);
    name.upward = true;
    draw_text(picture, {28.0, plot.top + 0.5 * plot.height}, "x (forward) [m]", name);
}

void draw_scale_bar(Picture& picture, const MapView& view) {
    const double plot_width_m = view.plot.width / view.px_per_m;
    const bool metre_fits = view.px_per_m >= 60.0 && plot_width_m >= 2.5;
    const double length_m = metre_fits ? 1.0 : nice_below(0.2 * plot_width_m);
    const int length_px = nearest_px(length_m * view.px_per_m);
    Ticks format;
    format.step = nice_below(length_m);
    // in range: nice_below() gives a finite length above 0, whose logarithm is within 324 of 0
    format.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(length_m) + 1e-9)));
    const std::string label = format.label(length_m) + " m";
    const int text_px = saturated_integer<int>(text_width_px(label, label_style(TextAnchor::left)));
    const int box_px = std::max(length_px, text_px) + 28;
    if (box_px + 28 > view.plot.width || view.plot.height < 82) return;
    const RectPx box{view.plot.left + 14, view.plot.bottom() - 14 - 54, box_px, 54};
    fill_rect(picture, box, palette::kPaper, 0.88);
    const double middle_u = box.left + 0.5 * box.width;
    draw_text(picture, {middle_u, box.top + 18.0}, label, label_style(TextAnchor::centre));
    fill_rect(picture,
              {box.left + (box.width - length_px) / 2, box.top + 36, length_px, 6},
              palette::kInk);
}

void draw_path(Picture& picture,
               const MapView& view,
               const std::vector<Eigen::Vector2d>& points_m,
               Rgb8 color,
               int width_px) {
    draw_polyline(picture, to_px(view, points_m), width_px, color);
}

namespace {

void draw_dots(Picture& picture, const MapView& view, const Dots& dots) {
    constexpr int kSide_px = 3;
    for (const Eigen::Vector2d& point_m : dots.points_m) {
        const PointPx p = view.to_px(point_m);
        const RectPx dot{
            nearest_px(p.u) - kSide_px / 2, nearest_px(p.v) - kSide_px / 2, kSide_px, kSide_px};
        fill_rect(picture, dot, dots.color);
    }
}

}  // namespace

void draw_overlays(Picture& picture, const MapView& view, const Overlays& overlays) {
    Picture part = cut_out(picture, view.plot);
    MapView inside = view;
    inside.plot.left = 0;
    inside.plot.top = 0;
    draw_dots(part, inside, overlays.dots);
    if (overlays.scale_bar) draw_scale_bar(part, inside);
    draw_path(part, inside, overlays.trajectory_m, palette::kPaper, 7);
    draw_path(part, inside, overlays.trajectory_m, palette::kInk, 3);
    for (const Outline& outline : overlays.outlines) {
        const std::vector<PointPx> points = to_px(inside, outline.points_m);
        draw_polyline(part, points, 7, palette::kPaper, true);
        draw_polyline(part, points, 3, outline.color, true);
    }
    draw_strokes(part, inside, overlays.strokes);
    draw_badges(part, inside, overlays.badges);
    if (overlays.T_odom_body && overlays.T_odom_body->all_finite())
        draw_body(part, inside, *overlays.T_odom_body, overlays.body_px);
    for (const Mark& mark : overlays.marks) {
        if (mark.point_m.allFinite()) draw_mark_symbol(part, inside.to_px(mark.point_m));
    }
    paste(picture, part, view.plot.left, view.plot.top);
}

std::vector<KeyEntry> key_of(const Overlays& overlays) {
    std::vector<KeyEntry> entries;
    if (overlays.T_odom_body) entries.push_back({Symbol::body, palette::kInk, "base_link", {}});
    if (overlays.trajectory_m.size() > 1) {
        entries.push_back({Symbol::line, palette::kInk, "path", {}});
    }
    for (const Outline& outline : overlays.outlines) {
        add_label(outline.label, Symbol::outline, outline.color, entries);
    }
    for (const Stroke& stroke : overlays.strokes) {
        add_label(
            stroke.label, stroke.ticks ? Symbol::ticked_line : Symbol::line, stroke.color, entries);
    }
    if (!overlays.dots.points_m.empty())
        entries.push_back(
            {Symbol::square, palette::kFaint, overlays.dots.label, overlays.dots.color});
    for (const Mark& mark : overlays.marks)
        entries.push_back({Symbol::mark, palette::kInk, mark.label, {}});
    return entries;
}

}  // namespace surefoot::eval
