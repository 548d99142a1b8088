// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/picture.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/eval/maps/cell_colors.hpp"
#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/picture_range.hpp"

namespace surefoot::eval {
namespace {

constexpr double kWantedSide_px = 800.0;
constexpr double kLargestSide_px = 1600.0;
constexpr int kConfusionCell_px = 3;  ///< smallest cell that shows a dot and its surrounding

/// Returns whole pixels per cell if the map fits, otherwise the fraction at which the map fits.
double px_per_cell(const grid::GridGeometry& geometry, int smallest_px) {
    const double longest = std::max({geometry.nx, geometry.ny, 1});
    if (longest > kLargestSide_px) return kLargestSide_px / longest;
    const double wanted = std::ceil(kWantedSide_px / longest);
    return longest * smallest_px <= kLargestSide_px ? std::max<double>(wanted, smallest_px)
                                                    : wanted;
}

struct MapFigure {
    Figure figure;
    MapView view;
    double cell_px = 1.0;
};

MapFigure make_map_figure(const grid::GridGeometry& geometry,
                          int smallest_cell_px,
                          const FigureText& text,
                          const ColumnSize& column) {
    MapFigure map;
    map.cell_px = px_per_cell(geometry, smallest_cell_px);
    const auto side = [&](int cells) { return std::max(1, nearest_px(cells * map.cell_px)); };
    map.figure = make_figure(side(geometry.ny), side(geometry.nx), true, column, text);
    map.view.plot = map.figure.plot;
    map.view.x_max_m = geometry.origin_m.x() + geometry.nx * geometry.resolution_m;
    map.view.y_max_m = geometry.origin_m.y() + geometry.ny * geometry.resolution_m;
    map.view.px_per_m = map.cell_px / geometry.resolution_m;
    return map;
}

/// Calls paint(cell, u, v) -> colour for every pixel of the plot. u and v are pixels of the plot,
/// not of the picture.
template <typename Paint>
void paint_cells(MapFigure& map, const grid::GridGeometry& geometry, const Paint& paint) {
    const RectPx& plot = map.figure.plot;
    const auto index = [&](int px, int count) {
        const int from_far_end = saturated_integer<int>((px + 0.5) / map.cell_px);
        return std::max(0, count - 1 - from_far_end);
    };
    for (int v = 0; v < plot.height; ++v) {
        for (int u = 0; u < plot.width; ++u) {
            const grid::Cell cell{index(v, geometry.nx), index(u, geometry.ny)};
            map.figure.picture.at(plot.left + u, plot.top + v) =
                geometry.contains(cell) ? paint(cell, u, v) : hatched_grey(u, v);
        }
    }
}

void draw_note(Picture& picture, const RectPx& plot, const std::string& note) {
    TextStyle style;
    style.anchor = TextAnchor::centre;
    style.cap_height_px = layout::kTitleCap_px;
    style.color = palette::kSoftInk;
    style.halo = true;
    draw_text(picture, {plot.left + 0.5 * plot.width, plot.top + 0.5 * plot.height}, note, style);
}

struct CallColors {
    Rgb8 ground;
    Rgb8 dot;
    double dot_share = 0.0;  ///< dot side / cell side; larger for errors, so that few errors stay
                             ///< visible
};

CallColors colors_of(Call call) {
    constexpr double kHit = 0.45;
    constexpr double kMiss = 0.78;
    switch (call) {
        case Call::true_safe: return {palette::kPaper, palette::kGreen, kHit};
        case Call::true_unsafe: return {palette::kBlack, palette::kGreen, kHit};
        case Call::false_safe: return {palette::kPaper, palette::kSafe, kMiss};
        case Call::false_unsafe: return {palette::kBlack, palette::kUnsafe, kMiss};
        case Call::unknown:
        case Call::no_truth: break;
    }
    return {palette::kFaint, palette::kFaint, 0.0};
}

/// Returns the colour of pixel (u, v) of the plot, in a cell with this call.
Rgb8 call_color(Call call, double side_px, int u, int v) {
    if (call == Call::no_truth) return hatched_grey(u, v);
    const CallColors colors = colors_of(call);
    if (side_px < kConfusionCell_px) return mixed(colors.ground, colors.dot, colors.dot_share);
    const int cell_px = saturated_integer<int>(side_px);
    const int dot_px = nearest_px(colors.dot_share * cell_px);
    const int first = (cell_px - dot_px) / 2;
    const auto in_middle = [&](int px) {
        return px % cell_px >= first && px % cell_px < first + dot_px;
    };
    return in_middle(u) && in_middle(v) ? colors.dot : colors.ground;
}

/// Range of cells [first, end) of one axis. `widen` extends it to `least` cells within the grid.
struct CellSpan {
    int first = 0;
    int end = 0;
    void include(int index) {
        first = end == 0 ? index : std::min(first, index);
        end = std::max(end, index + 1);
    }
    void widen(int least, int count) {
        const int missing = std::max(0, std::min(least, count) - (end - first));
        first = std::clamp(first - missing / 2, 0, std::max(0, count - least));
        end = std::min(count, std::max(end, first + std::min(least, count)));
    }
};

std::vector<KeyEntry> confusion_key() {
    const auto entry = [](Call call, const char* label) {
        const CallColors colors = colors_of(call);
        return KeyEntry{Symbol::square, colors.ground, label, colors.dot};
    };
    return {entry(Call::true_safe, "safe, rightly"),
            entry(Call::true_unsafe, "unsafe, rightly"),
            entry(Call::false_safe, "called safe, is NOT safe"),
            entry(Call::false_unsafe, "called unsafe, is safe"),
            {Symbol::square, palette::kFaint, "unknown in the live map", {}},
            {Symbol::hatch, {}, "no truth", {}}};
}

}  // namespace

LayerStyle elevation_style() {
    LayerStyle style;
    style.text.title = "Elevation";
    style.unit = "m";
    style.min_span = 0.2;
    style.hill_shading = true;
    return style;
}

LayerStyle traversability_style(double safe_threshold) {
    LayerStyle style;
    style.text.title = "Traversability";
    style.map = ColorMap::safety;
    style.range = ValueRange{0.0, 1.0};
    style.centre = safe_threshold;
    style.low_word = "unsafe";
    style.high_word = "safe";
    return style;
}

LayerStyle height_sigma_style() {
    LayerStyle style;
    style.text.title = "Height uncertainty (1 sigma)";
    style.unit = "mm";
    style.map = ColorMap::cividis;
    style.value_scale = 1000.0;
    style.min_span = 2.0;
    return style;
}

Picture render_layer(const grid::GridGeometry& geometry,
                     const grid::Layer& layer,
                     const LayerStyle& style,
                     const Overlays& overlays) {
    SUREFOOT_ASSERT(layer.width() == geometry.nx && layer.height() == geometry.ny);
    std::vector<KeyEntry> key = key_of(overlays);
    key.push_back({Symbol::hatch, {}, "unknown", {}});
    const ColorBar bar = color_bar_of(layer, style);
    MapFigure map = make_map_figure(geometry, 1, style.text, column_size(key, BarKind::one_scale));
    const auto colors = cell_colors(geometry, layer, style, bar.scale);
    paint_cells(map, geometry, [&](grid::Cell cell, int u, int v) {
        return colors.at(cell.ix, cell.iy).value_or(hatched_grey(u, v));
    });
    draw_overlays(map.figure.picture, map.view, overlays);
    draw_axes(map.figure.picture, map.view);
    if (!any_known(layer)) draw_note(map.figure.picture, map.figure.plot, "no cell is known");
    const int below = draw_color_bar(map.figure, bar, static_cast<int>(key.size()));
    draw_key(map.figure, below, key);
    return std::move(map.figure.picture);
}

Picture render_cells(const grid::GridGeometry& geometry,
                     const Image<std::optional<Rgb8>>& colors,
                     const std::vector<KeyEntry>& meaning,
                     const FigureText& text,
                     const Overlays& overlays) {
    SUREFOOT_ASSERT(colors.width() == geometry.nx && colors.height() == geometry.ny);
    std::vector<KeyEntry> key = meaning;
    for (KeyEntry& entry : key_of(overlays)) key.push_back(std::move(entry));
    MapFigure map = make_map_figure(geometry, 1, text, column_size(key, BarKind::none));
    paint_cells(map, geometry, [&](grid::Cell cell, int u, int v) {
        return colors.at(cell.ix, cell.iy).value_or(hatched_grey(u, v));
    });
    draw_overlays(map.figure.picture, map.view, overlays);
    draw_axes(map.figure.picture, map.view);
    draw_key(map.figure, map.figure.column.top, key);
    return std::move(map.figure.picture);
}

Picture render_error_map(const grid::GridGeometry& geometry,
                         const grid::Layer& error_m,
                         const FigureText& text,
                         const Overlays& overlays) {
    LayerStyle style;
    style.text = text;
    style.unit = "mm";
    style.map = ColorMap::balance;
    style.value_scale = 1000.0;
    style.min_span = 20.0;
    const ValueRange found = shown_range(error_m, style);
    const double reach = std::max(std::abs(found.low), std::abs(found.high));
    style.range = ValueRange{-reach, reach};
    style.centre = 0.0;
    style.low_word = "map too low";
    style.high_word = "map too high";
    return render_layer(geometry, error_m, style, overlays);
}

Picture render_confusion(const grid::GridGeometry& geometry,
                         const Image<Call>& calls,
                         const FigureText& text,
                         const Overlays& overlays) {
    SUREFOOT_ASSERT(calls.width() == geometry.nx && calls.height() == geometry.ny);
    std::vector<KeyEntry> key = confusion_key();
    for (KeyEntry& entry : key_of(overlays)) key.push_back(std::move(entry));
    MapFigure map =
        make_map_figure(geometry, kConfusionCell_px, text, column_size(key, BarKind::none));
    paint_cells(map, geometry, [&](grid::Cell cell, int u, int v) {
        return call_color(calls.at(cell.ix, cell.iy), map.cell_px, u, v);
    });
    draw_overlays(map.figure.picture, map.view, overlays);
    draw_axes(map.figure.picture, map.view);
    draw_key(map.figure, map.figure.column.top, key);
    return std::move(map.figure.picture);
}

Picture render_confusion_thumbnail(const grid::GridGeometry& geometry,
                                   const Image<Call>& calls,
                                   const Overlays& overlays) {
    SUREFOOT_ASSERT(calls.width() == geometry.nx && calls.height() == geometry.ny);
    CellSpan across;
    CellSpan along;
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) {
            if (calls.at(ix, iy) == Call::no_truth || calls.at(ix, iy) == Call::unknown) continue;
            along.include(ix);
            across.include(iy);
        }
    }
    if (along.end == 0) return {};
    for (const Eigen::Vector2d& p_m : overlays.trajectory_m) {
        const auto cell = geometry.cell_at(p_m.x(), p_m.y());
        if (!cell) continue;
        along.include(cell->ix);
        across.include(cell->iy);
    }
    along.widen(kThumbnailCells, geometry.nx);
    across.widen(kThumbnailCells, geometry.ny);
    constexpr int kCell_px = 4;
    const RectPx plot{
        0, 0, (across.end - across.first) * kCell_px, (along.end - along.first) * kCell_px};
    Picture picture(plot.width, plot.height);
    for (int v = 0; v < plot.height; ++v) {
        for (int u = 0; u < plot.width; ++u) {
            const Call call = calls.at(along.end - 1 - v / kCell_px, across.end - 1 - u / kCell_px);
            picture.at(u, v) = call_color(call, kCell_px, u, v);
        }
    }
    MapView view;
    view.plot = plot;
    view.x_max_m = geometry.origin_m.x() + along.end * geometry.resolution_m;
    view.y_max_m = geometry.origin_m.y() + across.end * geometry.resolution_m;
    view.px_per_m = kCell_px / geometry.resolution_m;
    draw_overlays(picture, view, overlays);
    return picture;
}

}  // namespace surefoot::eval
